// A robot without a network at first: it drives on from a start pose that is displaced and turned,
// and its session begins where nobody knows well where it is, over a poor link.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include <gmock/gmock.h>

#include "test/system/driven_world.hpp"
#include "test/system/run_watch.hpp"

namespace fleetloc {
namespace {

struct Start {
  int silent_s;
  int seed;  ///< of the losses
};
void PrintTo(const Start& start, std::ostream* stream) {
  *stream << start.silent_s << " s, seed " << start.seed;
}

class LateSession : public testing::TestWithParam<Start> {
 protected:
  LateSession() : world_(DrivenWorld::kept()) {}

  /// Silent for the first seconds; then 4 KB/s each way, half a second late, one datagram of ten
  /// lost.
  [[nodiscard]] std::filesystem::path link() const {
    const std::string direction =
        "{loss: 0.1, delay_s: 0.5, rate_bytes_per_s: 4000, queue_bytes: 8000, outages: [[0, " +
        std::to_string(GetParam().silent_s) + "]]}\n";
    const auto file = out_ / "link.yaml";
    std::ofstream(file) << "seed: " << GetParam().seed << "\nuplink: " << direction
                        << "downlink: " << direction;
    return file;
  }

  const ScratchFolder out_;
  const DrivenWorld world_;
};

TEST_P(LateSession, BelievesWhatFollowsItsFirstAnswer) {
  constexpr int kAfter = 10;  // [s]
  const auto run = out_ / "run";
  must_run(FLEETLOC_REPLAY,
           {"--dataset",
            world_.forward.folder,
            "--tracks",
            "--map",
            world_.map,
            "--initial-pose",
            world_.forward.start_pose_to_the_right(),
            "--link",
            link(),
            "--duration",
            std::to_string(GetParam().silent_s + kAfter),
            "--out",
            run});
  const auto answers = answers_of(run);
  const auto first = std::ranges::find_if(answers, &AnswerLine::applied);
  ASSERT_NE(first, answers.end());
  const auto refused =
      std::count_if(first, answers.end(), [](const AnswerLine& answer) { return !answer.applied; });
  ASSERT_EQ(frames_of(run).back().state, "localized") << refused << " answers refused";
  const auto errors = run_errors(run, world_.forward);
  std::cout << answers.end() - first << " answers from the first that was applied on, " << refused
            << " refused; largest error while localized " << errors.at("confidence").at("worst_m")
            << " m\n";
  EXPECT_LE(refused, 1);
  EXPECT_EQ(errors.at("confidence").at("confidently_wrong"), 0);
}

// After 12 s, first places were wrong, or the robot refused what followed, for each of these seeds.
INSTANTIATE_TEST_SUITE_P(
    AndSilentAtFirst,
    LateSession,
    testing::Values(Start{6, 1}, Start{12, 1}, Start{12, 2}, Start{12, 3}, Start{16, 1}));

}  // namespace
}  // namespace fleetloc
