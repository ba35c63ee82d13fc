#include "robot/dataset/track_files.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/faults/fault_injector.hpp"
#include "deploy/sim/recording/dataset_writer.hpp"
#include "robot/dataset/dataset_reader.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr int kFrames = 8;  // at 10 Hz

Timestamp at_ms(int milliseconds) {
  return Timestamp(std::chrono::milliseconds(milliseconds));
}

/// Landmarks number .. number + 3; none in the frame 5.
TrackedFrame frame(int number) {
  TrackedFrame result{.stamp = at_ms(100 * number), .observations = {}};
  for (int i = 0; i < 4 && number != 5; ++i) {
    result.observations.push_back({.landmark = LandmarkId(static_cast<std::uint32_t>(number + i)),
                                   .left = {100.25 + number, 50.0 + 1.0 / 3.0 * i},
                                   .disparity = i == 2 ? 0.0 : 12.5 + i});
  }
  return result;
}

class TrackFilesOfADataset : public ::testing::Test {
 protected:
  TrackFilesOfADataset() {
    std::filesystem::remove_all(folder_);
    Camera camera{.width_px = 16, .height_px = 12, .focal_px = {10, 10}, .center_px = {8, 6}};
    DatasetWriter dataset({.folder = folder_,
                           .calibration = {.cam0 = camera,
                                           .cam1 = camera,
                                           .T_body_cam0 = {},
                                           .T_body_cam1 = {.R = Eigen::Quaterniond::Identity(),
                                                           .p = {0.1, 0.0, 0.0}}},
                           .imu_noise = {1e-4, 1e-5, 1e-3, 1e-4},
                           .frame_rate_hz = 10.0,
                           .imu_rate_hz = 200.0});
    for (int ms = 0; ms <= 1000; ms += 5) {
      dataset.add(ImuSample{at_ms(ms), {}, {0.0, 0.0, 9.81}});
    }
    dataset.finish();
    TrackWriter tracks(folder_ / "mav0" / "tracks0");
    for (int i = 0; i < kFrames; ++i) tracks.add(frame(i));
    tracks.finish();
  }

  [[nodiscard]] std::vector<TrackedFrame> play(const FaultPlan& plan = {},
                                               double start_s = 0.0) const {
    auto recording = std::make_unique<DatasetReader>(
        DatasetReader::Options{.folder = folder_, .start_s = start_s, .tracks = true});
    const Timestamp start = recording->recording_start();
    FaultInjector input(std::move(recording), start, plan);
    std::vector<TrackedFrame> frames;
    while (auto item = input.next()) {
      if (auto* cameras = std::get_if<CameraFrame>(&*item)) {
        frames.push_back(std::get<TrackedFrame>(*cameras));
      }
    }
    return frames;
  }

  [[nodiscard]] std::string error_of_playing() const {
    try {
      static_cast<void>(play());
    } catch (const DatasetError& error) {
      return error.what();
    }
    return "no error";
  }

  void replace(const char* file, const std::string& text) const {
    std::ofstream(folder_ / "mav0" / "tracks0" / file) << text;
  }

  const std::filesystem::path folder_ = test_folder() / "tracks";
};

TEST_F(TrackFilesOfADataset, ReturnWhatWasWritten) {
  const auto frames = play();
  ASSERT_EQ(frames.size(), static_cast<std::size_t>(kFrames));
  for (int i = 0; i < kFrames; ++i) {
    const TrackedFrame expected = frame(i);
    const TrackedFrame& read = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(read.stamp, expected.stamp);
    ASSERT_EQ(read.observations.size(), expected.observations.size());
    for (std::size_t k = 0; k < read.observations.size(); ++k) {
      EXPECT_EQ(read.observations[k].landmark, expected.observations[k].landmark);
      EXPECT_LT((read.observations[k].left - expected.observations[k].left).norm(), 1e-4);
      EXPECT_NEAR(read.observations[k].disparity, expected.observations[k].disparity, 1e-4);
    }
  }
}

TEST_F(TrackFilesOfADataset, ArePlayedInPart) {
  const auto frames = play({}, 0.25);
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_EQ(frames.front().stamp, at_ms(300));
  EXPECT_EQ(frames.front().observations.front().landmark, LandmarkId{3});
}

TEST_F(TrackFilesOfADataset, SufferFaultsAsImagesDo) {
  const auto with = [this](FaultKind kind) {
    return play({.seed = 1, .faults = {{kind, 0.2, 0.15, 1.0}}});
  };
  EXPECT_THAT(with(FaultKind::kBlackImages)[2].observations, IsEmpty());
  EXPECT_EQ(with(FaultKind::kFrozenImages)[3].observations.front().landmark, LandmarkId{1});
  EXPECT_EQ(with(FaultKind::kMissingRight)[3].observations.front().disparity, 0.0);
  EXPECT_EQ(with(FaultKind::kMissingRight)[4].observations.front().disparity, 12.5);
  EXPECT_EQ(with(FaultKind::kDroppedFrames).size(), kFrames - 2U);
}

TEST_F(TrackFilesOfADataset, NameFileAndLineOfWhatIsWrong) {
  replace("observations.csv", "1,2.0,3.0,4.0\n2,2.0,3.0,-1\n");
  EXPECT_THAT(error_of_playing(), AllOf(HasSubstr("observations.csv:2"), HasSubstr("negative")));
  replace("observations.csv", "1,2.0,3.0,4.0\n1,2.0,3.0,4.0\n");
  EXPECT_THAT(error_of_playing(), AllOf(HasSubstr("observations.csv:2"), HasSubstr("greater")));
  replace("observations.csv", "1,2.0,3.0,4.0\n");
  EXPECT_THAT(error_of_playing(), HasSubstr("observations.csv: ends before the last frame"));
  replace("observations.csv", "1.5,2.0,3.0,4.0\n");
  EXPECT_THAT(error_of_playing(), AllOf(HasSubstr("observations.csv:1"), HasSubstr("'1.5'")));
  replace("data.csv", "1000,4\n1000,4\n");
  EXPECT_THAT(error_of_playing(), AllOf(HasSubstr("data.csv:2"), HasSubstr("not later")));
  std::filesystem::remove_all(folder_ / "mav0" / "tracks0");
  EXPECT_THAT(error_of_playing(), HasSubstr("observations.csv: no such file"));
}

}  // namespace
}  // namespace fleetloc
