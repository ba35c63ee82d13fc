// fleetloc-replay --faults: each fault alone, on 20 s of a flight, against the ground truth.
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <stdexcept>
#include <utility>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/config/delimited_file.hpp"
#include "shared/trajectory/tum_file.hpp"
#include "test/system/recorded_flight.hpp"

namespace fleetloc {
namespace {

using ::testing::Le;

struct FaultCase {
  const char* name;
  std::vector<std::string> faults;  ///< in the file's own words, without braces
  std::uint64_t at_least = 0;       ///< so many measurements are touched
};
void PrintTo(const FaultCase& fault, std::ostream* stream) {
  *stream << fault.name;
}

std::vector<FaultCase> cases() {
  return {
      {"BlackImages", {"kind: black_images, start_s: 9, duration_s: 2"}, 40},
      {"FrozenImages", {"kind: frozen_images, start_s: 9, duration_s: 2"}, 40},
      {"SaturatedImages", {"kind: saturated_images, start_s: 9, duration_s: 2"}, 40},
      {"NoLeftCamera", {"kind: missing_left, start_s: 9, duration_s: 2"}, 40},
      {"NoRightCamera", {"kind: missing_right, start_s: 9, duration_s: 2"}, 40},
      {"DroppedFrames", {"kind: dropped_frames, start_s: 0, duration_s: 60, share: 0.3"}, 80},
      {"ImuGaps",
       {"kind: imu_gap, start_s: 6, duration_s: 0.2",
        "kind: imu_gap, start_s: 9.02, duration_s: 0.2",
        "kind: imu_gap, start_s: 12.55, duration_s: 0.2"},
       120},
      {"DoubledStamps",
       {"kind: doubled_frames, start_s: 0, duration_s: 60, share: 0.2",
        "kind: doubled_imu, start_s: 0, duration_s: 60, share: 0.2"},
       800},
      {"DisorderedStamps",
       {"kind: disordered_frames, start_s: 0, duration_s: 60, share: 0.1",
        "kind: disordered_imu, start_s: 0, duration_s: 60, share: 0.1"},
       400},
  };
}

/// What is said of the position in the map at one frame, and how far off it is.
struct CheckedFrame {
  std::string state;
  double error_m = 0.0;
  double sigmas = 0.0;  ///< of the error, by the covariance that was stated with it
};

std::vector<CheckedFrame> checked_frames(const std::filesystem::path& run,
                                         const RecordedFlight& flight) {
  constexpr std::chrono::milliseconds kMaxGap{100};
  const auto truth = read_trajectory(flight.ground_truth);
  const auto estimate = read_trajectory(run / "localization_frames.tum");
  DelimitedFile file(run / "diagnostics.csv", ',');
  file.next();
  const auto column = [&](const std::string& name) {
    for (std::size_t i = 0; i < file.columns(); ++i) {
      if (file.text(i) == name) return i;
    }
    throw std::runtime_error("no column " + name);
  };
  const std::array columns{column("cm44"),
                           column("cm45"),
                           column("cm46"),
                           column("cm55"),
                           column("cm56"),
                           column("cm66")};
  std::vector<CheckedFrame> frames;
  for (const StampedPose& pose : estimate) {
    while (file.next() && file.seconds(0) < pose.stamp) {
    }
    const auto T_map_body = interpolate(truth, pose.stamp, kMaxGap);
    if (!T_map_body) continue;
    std::array<double, 6> c{};
    std::ranges::transform(columns, c.begin(), [&](std::size_t i) { return file.number(i); });
    Eigen::Matrix3d covariance;  // in body axes
    covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
    const Eigen::Vector3d error =
        pose.T_ref_body.R.conjugate() * (T_map_body->p - pose.T_ref_body.p);
    frames.push_back({std::string(file.text(1)),
                      error.norm(),
                      std::sqrt(error.dot(covariance.ldlt().solve(error)))});
  }
  return frames;
}

class Faults : public testing::TestWithParam<FaultCase> {
 protected:
  static void SetUpTestSuite() {
    if (skipped()) return;
    scratch_ = new ScratchFolder;
    map_ = built_map(vicon_room(), *scratch_);
  }
  static void TearDownTestSuite() { delete std::exchange(scratch_, nullptr); }
  void SetUp() override {
    if (skipped()) GTEST_SKIP() << "no recordings in " << recordings() << ", or sanitizers";
  }
  static bool skipped() { return kSanitized || !std::filesystem::is_directory(recordings()); }

  static std::filesystem::path replay(const FaultCase& fault) {
    const auto plan = *scratch_ / (std::string(fault.name) + ".yaml");
    std::ofstream stream(plan);
    stream << "seed: 5\nfaults:\n";
    for (const std::string& line : fault.faults) stream << "  - {" << line << "}\n";
    stream.close();
    auto folder = *scratch_ / fault.name;
    const Outcome outcome = run(FLEETLOC_REPLAY,
                                {"--dataset",
                                 vicon_room().folder.string(),
                                 "--out",
                                 folder.string(),
                                 "--map",
                                 map_.string(),
                                 "--initial-pose",
                                 vicon_room().displaced_start_pose(),
                                 "--duration",
                                 "20",
                                 "--faults",
                                 plan.string()});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    return folder;
  }

  static inline ScratchFolder* scratch_ = nullptr;
  static inline std::filesystem::path map_;
};

// Fails if any of them is confidently wrong.
double worst_while_localized(const std::vector<CheckedFrame>& frames) {
  double worst = 0.0;
  for (const CheckedFrame& frame : frames) {
    if (frame.state != "localized") continue;
    worst = std::max(worst, frame.error_m);
    EXPECT_FALSE(frame.error_m > 0.5 && frame.sigmas > 3.0)
        << frame.error_m << " m, " << frame.sigmas << " sigmas";
  }
  return worst;
}

TEST_P(Faults, AreSurvivedCountedAndNeverMakeAPoseConfidentlyWrong) {
  const auto folder = replay(GetParam());
  const auto summary = parsed_json(folder / "summary.json");
  std::uint64_t injected = 0;
  for (const auto& [kind, count] : summary.at("input_faults").items()) {
    if (kind.starts_with("injected_")) injected += count.get<std::uint64_t>();
  }
  EXPECT_GE(injected, GetParam().at_least);

  const auto frames = checked_frames(folder, vicon_room());
  ASSERT_FALSE(frames.empty());
  const double worst = worst_while_localized(frames);
  EXPECT_EQ(frames.back().state, "localized");
  EXPECT_THAT(frames.back().error_m, Le(0.1));
  const auto errors = run_errors(folder, vicon_room());
  std::cout << std::left << std::setw(18) << GetParam().name << " resets " << summary.at("resets")
            << ", coverage " << summary.at("coverage").get<double>() << ", ATE median "
            << errors.at("ate").at("median").get<double>() << " m, worst while localized " << worst
            << " m\n";
  EXPECT_THAT(errors.at("ate").at("median").get<double>(), Le(0.07));  // 0.035 without faults
}

class LongFaults : public Faults {};

TEST_P(LongFaults, ResetTheOdometryAndNeverMakeAPoseConfidentlyWrong) {
  const auto folder = replay(GetParam());
  EXPECT_EQ(parsed_json(folder / "summary.json").at("resets"), 1);
  const auto frames = checked_frames(folder, vicon_room());
  ASSERT_FALSE(frames.empty());
  worst_while_localized(frames);
}

INSTANTIATE_TEST_SUITE_P(Replay, Faults, testing::ValuesIn(cases()), [](const auto& one) {
  return std::string(one.param.name);
});

// Where the localizer, started from what is left of the pose, would settle a metre off.
INSTANTIATE_TEST_SUITE_P(
    Replay,
    LongFaults,
    testing::Values(FaultCase{"ImuGap", {"kind: imu_gap, start_s: 6, duration_s: 1"}},
                    FaultCase{"Darkness", {"kind: black_images, start_s: 6, duration_s: 5"}}),
    [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace fleetloc
