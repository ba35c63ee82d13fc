// Robots that somebody carries away: the localizer notices, searches its map, and puts them right.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "test/system/checked_frames.hpp"
#include "test/system/driven_world.hpp"
#include "test/system/run_watch.hpp"

namespace fleetloc {
namespace {

bool is_localized(const CheckedFrame& frame) {
  return frame.state == "localized";
}

class Kidnapped : public testing::Test {
 protected:
  Kidnapped() : map_(DrivenWorld::kept().map) {}

  void play(const RecordedFlight& flight, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"--dataset",
                                   flight.folder,
                                   "--tracks",
                                   "--map",
                                   map_,
                                   "--initial-pose",
                                   flight.displaced_start_pose(),
                                   "--out",
                                   out_ / "run"};
    words.insert(words.end(), more.begin(), more.end());
    must_run(FLEETLOC_REPLAY, words);
    frames_ = checked_frames(out_ / "run", flight);
    begin_ = first_frame(flight.folder);
  }

  [[nodiscard]] double second(const CheckedFrame& frame) const {
    return to_seconds(frame.stamp - begin_);
  }
  /// Of the localized frames from `from_s` on.
  [[nodiscard]] double worst_m(double from_s, double to_s = 1e9) const {
    double worst = 0.0;
    for (const CheckedFrame& frame : frames_) {
      const double t = second(frame);
      if (t >= from_s && t < to_s && is_localized(frame)) worst = std::max(worst, frame.error_m);
    }
    return worst;
  }
  /// Seconds until the first localized frame from `from_s` on that is right.
  [[nodiscard]] std::optional<double> right_after(double from_s) const {
    const auto right = std::ranges::find_if(frames_, [&](const CheckedFrame& frame) {
      return second(frame) >= from_s && is_localized(frame) && frame.error_m < 0.25;
    });
    return right == frames_.end() ? std::nullopt : std::optional(second(*right) - from_s);
  }

  const ScratchFolder out_;
  const std::filesystem::path map_;
  std::vector<CheckedFrame> frames_;
  Timestamp begin_;
};

// At 2 m/s: noticed after the newest keyframes see too little that fits, and 6 m more.
TEST_F(Kidnapped, IsNoticedAndPutRightThoughItsOdometryGoesOn) {
  constexpr double kCarried_s = 40.0;
  constexpr double kNoticed_s = 10.0;
  play(DrivenWorld::carried(40, 65));
  EXPECT_LT(worst_m(0.0, kCarried_s), 0.25);
  EXPECT_GT(worst_m(kCarried_s, kCarried_s + kNoticed_s), 10.0) << "it was not carried away";
  const auto lost = std::ranges::find_if(frames_, [&](const CheckedFrame& frame) {
    return second(frame) > kCarried_s && frame.state == "lost";
  });
  ASSERT_NE(lost, frames_.end());
  const auto right_s = right_after(second(*lost));
  ASSERT_TRUE(right_s);
  std::cout << "lost after " << second(*lost) - kCarried_s << " s, right " << *right_s
            << " s later\n";
  EXPECT_LE(second(*lost), kCarried_s + kNoticed_s);
  EXPECT_LT(worst_m(second(*lost)), 0.25) << "it was sure of a wrong place once more";
  EXPECT_LT(second(*lost) + *right_s, kCarried_s + 30.0);
}

// Switched off, carried, and switched on again while it moves.
TEST_F(Kidnapped, IsLostAfterAResetAndFoundInTheWholeMap) {
  constexpr double kOff_s = 30.0;
  constexpr double kOn_s = 50.0;
  const auto faults = out_ / "faults.yaml";
  std::ofstream(faults) << "seed: 1\nfaults:\n"
                        << "  - {kind: imu_gap, start_s: 30, duration_s: 20}\n"
                        << "  - {kind: dropped_frames, start_s: 30, duration_s: 20, share: 1.0}\n";
  play(DrivenWorld::kept().forward, {"--faults", faults, "--duration", "90"});
  const auto right_s = right_after(kOn_s);
  ASSERT_TRUE(right_s);
  std::cout << "right after " << *right_s << " s\n";
  EXPECT_LT(*right_s, 20.0);
  EXPECT_LT(worst_m(kOff_s + 0.2), 0.25);
  EXPECT_TRUE(std::ranges::any_of(frames_, [&](const CheckedFrame& frame) {
    return second(frame) > kOn_s && frame.state == "lost";
  }));
}

}  // namespace
}  // namespace fleetloc
