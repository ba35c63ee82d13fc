#include "deploy/faults/fault_injector.hpp"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "deploy/sim/recording/dataset_writer.hpp"
#include "robot/dataset/dataset_reader.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// Frame i, of gray value i, at 50 i ms; IMU each 5 ms.
std::filesystem::path written_recording() {
  static const std::filesystem::path folder = [] {
    Camera camera{
        .width_px = 16, .height_px = 12, .focal_px = {10.0, 10.0}, .center_px = {8.0, 6.0}};
    StereoCalibration calibration{
        .cam0 = camera, .cam1 = camera, .T_body_cam0 = {}, .T_body_cam1 = {}};
    calibration.T_body_cam1.p.x() = 0.1;
    auto path = test_folder() / "fleetloc_faults";
    DatasetWriter writer({.folder = path,
                          .calibration = calibration,
                          .imu_noise = {1e-4, 1e-5, 1e-3, 1e-4},
                          .frame_rate_hz = 20.0,
                          .imu_rate_hz = 200.0});
    for (int i = 0; i <= 420; ++i) {
      writer.add(ImuSample{Timestamp(std::chrono::milliseconds(5 * i)), {}, {0.0, 0.0, 9.81}});
    }
    for (int i = 0; i < 40; ++i) {
      const cv::Mat image(12, 16, CV_8U, cv::Scalar(10 + i));
      writer.add(StereoFrame{Timestamp(std::chrono::milliseconds(50 * i)), image, image});
    }
    writer.finish();
    return path;
  }();
  return folder;
}

struct Played {
  std::vector<StereoFrame> frames;
  std::vector<ImuSample> imu;
  std::vector<ClockStep> steps;
  std::map<std::string, std::uint64_t> faults;
};

Played play(const FaultPlan& plan, double start_s = 0.0) {
  auto recording = std::make_unique<DatasetReader>(
      DatasetReader::Options{.folder = written_recording(), .start_s = start_s});
  const Timestamp start = recording->recording_start();
  FaultInjector input(std::move(recording), start, plan);
  Played played;
  while (auto item = input.next()) {
    if (auto* frame = std::get_if<CameraFrame>(&*item)) {
      played.frames.push_back(std::get<StereoFrame>(*frame));
    }
    if (auto* sample = std::get_if<ImuSample>(&*item)) played.imu.push_back(*sample);
    if (auto* step = std::get_if<ClockStep>(&*item)) {
      EXPECT_EQ(played.imu.size(), 201U);  // it comes before its first sample
      played.steps.push_back(*step);
    }
  }
  EXPECT_FALSE(input.next());
  played.faults = input.close();
  return played;
}

Played play(FaultKind kind, double start_s, double duration_s, double share = 1.0) {
  return play({.seed = 3, .faults = {{kind, start_s, duration_s, share}}});
}

int gray(const cv::Mat& image) {
  return image.empty() ? -1 : image.at<std::uint8_t>(3, 3);
}

bool same(const Played& a, const Played& b) {
  const auto by_stamp = [](const auto& x, const auto& y) { return x.stamp == y.stamp; };
  return std::ranges::equal(a.imu, b.imu, by_stamp) &&
         std::ranges::equal(a.frames, b.frames, by_stamp);
}

TEST(FaultInjector, PassesARecordingOnWithoutFaults) {
  const Played played = play(FaultPlan{});
  ASSERT_EQ(played.frames.size(), 40U);
  EXPECT_EQ(gray(played.frames[7].right), 17);
  EXPECT_EQ(played.faults, DatasetReader({.folder = written_recording()}).close());
}

TEST(FaultInjector, PaintsFreezesAndTakesAwayImagesForTheStatedTime) {
  const auto grays = [](FaultKind kind) {
    const Played played = play(kind, 0.5, 0.2);
    EXPECT_EQ(played.frames.size(), 40U);
    EXPECT_EQ(played.faults.at("injected_" + std::string(name(kind))), 4U);
    EXPECT_EQ(gray(played.frames[9].left), 19);  // before and after it nothing happens
    EXPECT_EQ(gray(played.frames[14].left), 24);
    EXPECT_EQ(gray(played.frames[14].right), 24);
    return std::pair(gray(played.frames[10].left), gray(played.frames[13].right));
  };
  EXPECT_EQ(grays(FaultKind::kBlackImages), std::pair(0, 0));
  EXPECT_EQ(grays(FaultKind::kSaturatedImages), std::pair(255, 255));
  EXPECT_EQ(grays(FaultKind::kFrozenImages), std::pair(19, 19));
  EXPECT_EQ(grays(FaultKind::kMissingLeft), std::pair(-1, 23));
  EXPECT_EQ(grays(FaultKind::kMissingRight), std::pair(20, -1));
}

TEST(FaultInjector, DropsAShareOfTheFramesAndAllImuSamplesOfAGap) {
  const Played frames = play(FaultKind::kDroppedFrames, 0.0, 10.0, 0.3);
  const std::uint64_t dropped = frames.faults.at("injected_dropped_frames");
  EXPECT_EQ(frames.frames.size(), 40U - dropped);
  EXPECT_NEAR(static_cast<double>(dropped), 12.0, 6.0);
  const Played gap = play(FaultKind::kImuGap, 1.0, 0.2);
  EXPECT_EQ(gap.faults.at("injected_imu_gap"), 40U);
  EXPECT_TRUE(std::ranges::none_of(gap.imu, [](const ImuSample& sample) {
    const double t = to_seconds(sample.stamp - Timestamp{});
    return t >= 1.0 && t < 1.2 - 1e-9;
  }));
}

TEST(FaultInjector, DoublesAndDisordersStamps) {
  const auto steps_back = [](const auto& measurements) {
    std::pair<int, int> repeated_and_back;
    for (std::size_t i = 1; i < measurements.size(); ++i) {
      repeated_and_back.first += measurements[i].stamp == measurements[i - 1].stamp ? 1 : 0;
      repeated_and_back.second += measurements[i].stamp < measurements[i - 1].stamp ? 1 : 0;
    }
    return repeated_and_back;
  };
  EXPECT_EQ(steps_back(play(FaultKind::kDoubledFrames, 0.5, 0.2).frames), std::pair(4, 0));
  EXPECT_EQ(steps_back(play(FaultKind::kDoubledImu, 0.5, 0.1).imu), std::pair(20, 0));
  const Played late = play(FaultKind::kDisorderedFrames, 0.5, 0.05);
  EXPECT_EQ(late.frames.size(), 40U);  // none is lost
  EXPECT_EQ(steps_back(late.frames), std::pair(0, 1));
  EXPECT_EQ(gray(late.frames[10].left), 21);
  EXPECT_EQ(gray(late.frames[11].left), 20);
  EXPECT_EQ(steps_back(play(FaultKind::kDisorderedImu, 0.5, 0.005).imu), std::pair(0, 1));
}

TEST(FaultInjector, MakesImuSamplesThatAreNotFinite) {
  const Played played = play(FaultKind::kNonFiniteImu, 0.0, 10.0, 0.2);
  const auto broken = std::ranges::count_if(played.imu, [](const ImuSample& sample) {
    return !sample.angular_velocity.allFinite() && !sample.specific_force.allFinite();
  });
  EXPECT_EQ(static_cast<std::uint64_t>(broken), played.faults.at("injected_non_finite_imu"));
  EXPECT_GT(broken, 0);
}

TEST(FaultInjector, CutsImagesToAnotherSize) {
  const Played played = play(FaultKind::kResizedImages, 0.5, 0.2);
  EXPECT_EQ(played.frames[9].left.size(), cv::Size(16, 12));
  EXPECT_EQ(played.frames[10].left.size(), cv::Size(8, 6));
  EXPECT_EQ(played.frames[13].right.size(), cv::Size(8, 6));
  EXPECT_EQ(gray(played.frames[13].right), 23);
  EXPECT_EQ(played.frames[14].right.size(), cv::Size(16, 12));
}

TEST(FaultInjector, TakesStampsAway) {
  const auto without = [](const auto& measurements) {
    return std::ranges::count(measurements, Timestamp{}, [](const auto& one) { return one.stamp; });
  };
  const Played images = play(FaultKind::kZeroImageStamps, 0.5, 0.2);
  EXPECT_EQ(without(images.frames), 1 + 4);  // the recording starts at zero
  EXPECT_EQ(without(images.imu), 1);
  const Played imu = play(FaultKind::kZeroImuStamps, 0.5, 0.2);
  EXPECT_EQ(without(imu.frames), 1);
  EXPECT_EQ(without(imu.imu), 1 + 40);
}

TEST(FaultInjector, SetsTheClockOfImuAndCamerasForGood) {
  const FaultPlan plan{
      .seed = 3, .faults = {{.kind = FaultKind::kClockStep, .start_s = 1.003, .step_s = -10.0}}};
  const Played played = play(plan);
  const auto stamp_ms = [](const auto& one) {
    return std::chrono::duration_cast<std::chrono::milliseconds>(one.stamp.time_since_epoch())
        .count();
  };
  EXPECT_EQ(stamp_ms(played.imu[200]), 1000);
  EXPECT_EQ(stamp_ms(played.imu[201]), 1005 - 10000);
  EXPECT_EQ(stamp_ms(played.imu[390]), 1950 - 10000);
  EXPECT_EQ(stamp_ms(played.frames[20]), 1000);
  EXPECT_EQ(stamp_ms(played.frames[21]), 1050 - 10000);
  ASSERT_EQ(played.steps.size(), 1U);
  EXPECT_EQ(stamp_ms(played.steps[0]), 1005 - 10000);
  EXPECT_EQ(played.steps[0].unseen, Duration(std::chrono::milliseconds(5)));
  EXPECT_EQ(played.faults.at("injected_clock_step"), 1U);
}

TEST(FaultInjector, CountsTimeFromTheFirstImageOfTheRecordingWhateverPartIsPlayed) {
  const FaultPlan plan{.seed = 1, .faults = {{FaultKind::kBlackImages, 1.0, 0.1, 1.0}}};
  const Played played = play(plan, 0.9);
  EXPECT_EQ(gray(played.frames[0].left), 28);
  EXPECT_EQ(gray(played.frames[2].left), 0);
}

TEST(FaultInjector, DrawsTheSameForOneSeedAndLetsNoFaultDisturbAnother) {
  const Fault drop{FaultKind::kDroppedFrames, 0.0, 10.0, 0.3};
  const Fault twice{FaultKind::kDoubledImu, 0.0, 10.0, 0.3};
  EXPECT_TRUE(same(play({3, {drop, twice}}), play({3, {drop, twice}})));
  EXPECT_FALSE(same(play({3, {drop, twice}}), play({4, {drop, twice}})));
  EXPECT_EQ(play({3, {drop}}).frames.size(), play({3, {drop, twice}}).frames.size());
}

std::string error_of(const std::string& yaml) {
  try {
    read_fault_plan(ConfigReader::from_string(yaml, "faults.yaml"));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(FaultPlan, IsReadStrictly) {
  const FaultPlan plan = read_fault_plan(ConfigReader::from_string(
      "seed: 7\nfaults:\n"
      "  - {kind: imu_gap, start_s: 3, duration_s: 0.2}\n"
      "  - {kind: dropped_frames, start_s: 0, duration_s: 60, share: 0.3}\n"));
  EXPECT_EQ(plan.seed, 7U);
  ASSERT_EQ(plan.faults.size(), 2U);
  EXPECT_EQ(plan.faults[0].kind, FaultKind::kImuGap);
  EXPECT_EQ(plan.faults[0].duration_s, 0.2);
  EXPECT_EQ(plan.faults[1].share, 0.3);

  EXPECT_THAT(error_of("faults: []"), HasSubstr("seed: missing"));
  EXPECT_THAT(error_of("seed: 1\nfaults: [1]"), HasSubstr("line 2: faults[0]: expected a mapping"));
  const std::string one = "seed: 1\nfaults:\n  - ";
  EXPECT_THAT(error_of(one + "{kind: fog, start_s: 0, duration_s: 1}"), HasSubstr("'fog'"));
  EXPECT_THAT(error_of(one + "{kind: imu_gap, start_s: -1, duration_s: 1}"), HasSubstr("start_s"));
  EXPECT_THAT(error_of(one + "{kind: imu_gap, start_s: .nan, duration_s: 1}"),
              HasSubstr("start_s"));
  EXPECT_THAT(error_of(one + "{kind: imu_gap, start_s: 0, duration_s: 0}"),
              HasSubstr("duration_s: must be positive"));
  EXPECT_THAT(error_of(one + "{kind: imu_gap, start_s: 0, duration_s: 1, share: 1}"),
              AllOf(HasSubstr("line 3: faults[0]"), HasSubstr("share: unknown key")));
  EXPECT_THAT(error_of(one + "{kind: clock_step, start_s: 0, duration_s: 1}"),
              HasSubstr("step_s: missing"));
  EXPECT_THAT(error_of(one + "{kind: clock_step, start_s: 0, step_s: .nan}"), HasSubstr("step_s"));
  EXPECT_THAT(error_of(one + "{kind: clock_step, start_s: 0, step_s: 1, duration_s: 1}"),
              HasSubstr("duration_s: unknown key"));
  EXPECT_THAT(error_of(one + "{kind: doubled_imu, start_s: 0, duration_s: 1, share: 2}"),
              HasSubstr("share: must be at most 1"));
}

}  // namespace
}  // namespace fleetloc
