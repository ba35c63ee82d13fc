#include "robot/dataset/dataset_reader.hpp"

#include <algorithm>
#include <iterator>

#include <gmock/gmock.h>

#include "test/unit/dataset/written_dataset.hpp"

namespace fleetloc {
namespace {

TEST_F(Dataset, ReturnsWhatWasWrittenAsPng) {
  write_all();
  const auto items = play();
  const auto frames = frames_of(items);
  ASSERT_EQ(frames.size(), 10U);
  for (int i = 0; i < 10; ++i) {
    const StereoFrame& read = frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(read.stamp, frame(i).stamp);
    EXPECT_EQ(cv::norm(read.left, frame(i).left, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(read.right, frame(i).right, cv::NORM_INF), 0.0);
  }
  std::int64_t ms = 0;
  for (const auto& item : items) {
    if (const auto* sample = std::get_if<ImuSample>(&item)) {
      EXPECT_EQ(sample->stamp, at_ms(ms));
      EXPECT_EQ(sample->angular_velocity, imu_sample(ms).angular_velocity);
      EXPECT_EQ(sample->specific_force, imu_sample(ms).specific_force);
      ms += 5;
    }
  }
  EXPECT_EQ(ms - 5, 555);  // the first sample after the last image
}

TEST_F(Dataset, ReturnsTheCalibrationThatWasWritten) {
  write_all();
  const DatasetReader reader({.folder = folder_});
  const StereoCalibration expected = calibration();
  const StereoCalibration& read = reader.calibration();
  EXPECT_EQ(read.cam0.focal_px, expected.cam0.focal_px);
  EXPECT_EQ(read.cam0.center_px, expected.cam0.center_px);
  EXPECT_EQ(read.cam0.coefficients, expected.cam0.coefficients);
  EXPECT_EQ(read.cam0.distortion, expected.cam0.distortion);
  EXPECT_EQ(read.cam1.distortion, expected.cam1.distortion);
  EXPECT_LT(local_coordinates(read.T_body_cam0, expected.T_body_cam0).norm(), 1e-14);
  EXPECT_LT(local_coordinates(read.T_body_cam1, expected.T_body_cam1).norm(), 1e-14);
  EXPECT_EQ(reader.imu_noise().gyroscope_random_walk, kNoise.gyroscope_random_walk);
  EXPECT_EQ(reader.imu_noise().accelerometer_noise_density, kNoise.accelerometer_noise_density);
  EXPECT_EQ(reader.frame_count(), 10U);
}

TEST_F(Dataset, ReturnsNearlyTheSameImagesFromJpeg) {
  write_all(ImageFormat::kJpeg);
  const auto frames = frames_of(play());
  ASSERT_EQ(frames.size(), 10U);
  EXPECT_LE(cv::norm(frames[4].left, frame(4).left, cv::NORM_INF), 4.0);
  EXPECT_EQ(frames[4].left.type(), CV_8U);
}

TEST_F(Dataset, PlaysInTheOrderOfTimeWithImuFirst) {
  write_all();
  const auto items = play();
  for (std::size_t i = 1; i < items.size(); ++i) {
    EXPECT_LE(stamp_of(items[i - 1]), stamp_of(items[i]));
    if (std::holds_alternative<CameraFrame>(items[i])) {
      ASSERT_TRUE(std::holds_alternative<ImuSample>(items[i - 1]));
      EXPECT_EQ(stamp_of(items[i - 1]), stamp_of(items[i]));  // inclusive
    }
  }
}

TEST_F(Dataset, PlaysAPartAsAPrefixOfTheWhole) {
  write_all();
  const auto whole = play();
  const auto part = play({.folder = {}, .start_s = 0.0, .duration_s = 0.2});
  ASSERT_EQ(frames_of(part).size(), 5U);
  ASSERT_LT(part.size(), whole.size());
  EXPECT_EQ(stamp_of(part.back()), at_ms(305));  // one sample after the last image
  const auto same = [](const auto& a, const auto& b) {
    return a.index() == b.index() && stamp_of(a) == stamp_of(b);
  };
  EXPECT_TRUE(std::equal(part.begin(), part.end(), whole.begin(), same));
}

TEST_F(Dataset, CountsStartAndDurationFromTheFirstImage) {
  write_all();
  const auto frames = frames_of(play({.folder = {}, .start_s = 0.1, .duration_s = 0.1}));
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames.front().stamp, at_ms(200));
  EXPECT_EQ(frames.back().stamp, at_ms(300));
  EXPECT_THROW(play({.folder = {}, .start_s = 99.0}), DatasetError);
}

TEST_F(Dataset, PairsImagesByStampAndCountsWhatHasNoPartner) {
  {
    DatasetWriter dataset = writer();
    for (std::int64_t ms = 0; ms <= 400; ms += 5) dataset.add(imu_sample(ms));
    StereoFrame left_only = frame(1);
    left_only.right = cv::Mat();
    StereoFrame right_only = frame(2);
    right_only.left = cv::Mat();
    for (const StereoFrame& one : {frame(0), left_only, right_only, frame(3)}) dataset.add(one);
    dataset.finish();
  }
  // The right camera's clock is a millisecond off.
  edit("cam1/data.csv", [](int, const std::string& line) {
    if (line[0] == '#') return line;
    const auto stamp = std::stoll(line.substr(0, 19)) + 1'000'000;
    return std::to_string(stamp) + line.substr(19);
  });
  const auto frames = frames_of(play());
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_FALSE(frames[0].left.empty() || frames[0].right.empty());
  EXPECT_EQ(frames[0].stamp, at_ms(100));
  EXPECT_TRUE(frames[1].right.empty() && !frames[1].left.empty());
  EXPECT_TRUE(frames[2].left.empty() && !frames[2].right.empty());
  EXPECT_EQ(faults_.at("unpaired_images"), 2U);
  EXPECT_EQ(faults_.at("dropped_frames"), 0U);
}

TEST_F(Dataset, RefusesCamerasThatAreNeverOfOneInstant) {
  write_all();
  edit("cam1/data.csv", [](int, const std::string& line) {
    if (line[0] == '#') return line;
    return std::to_string(std::stoll(line.substr(0, 19)) - 3'000'000) + line.substr(19);
  });
  try {
    play();
    FAIL();
  } catch (const DatasetError& error) {
    EXPECT_THAT(error.what(),
                testing::AllOf(testing::HasSubstr("cam0/data.csv"),
                               testing::HasSubstr("within 2.000 ms"),
                               testing::HasSubstr("3.000 ms apart")));
  }
}

TEST_F(Dataset, SurvivesDroppedFramesAndAnImuGapAndCountsThem) {
  write_all();
  const auto drop = [](int number, const std::string& line) {
    return number == 5 || number == 6 ? std::string() : line;
  };
  edit("cam0/data.csv", drop);
  edit("cam1/data.csv", drop);
  edit("imu0/data.csv", [](int number, const std::string& line) {
    return number > 60 && number < 80 ? std::string() : line;
  });
  EXPECT_EQ(frames_of(play()).size(), 8U);
  EXPECT_EQ(faults_.at("dropped_frames"), 2U);
  EXPECT_EQ(faults_.at("imu_gaps"), 1U);
}

TEST_F(Dataset, PlaysImagesToTheEndIfTheImuEndsEarly) {
  write_all();
  edit("imu0/data.csv",
       [](int number, const std::string& line) { return number > 60 ? std::string() : line; });
  EXPECT_EQ(frames_of(play()).size(), 10U);
  EXPECT_EQ(faults_.at("imu_gaps"), 1U);
}

TEST_F(Dataset, StatesPosesInTheImusFrame) {
  write_all();
  edit("imu0/sensor.yaml", [](int, const std::string& line) {
    return line.find("data: [") == std::string::npos
               ? line
               : std::string("  data: [0, -1, 0, 0.5,");  // a quarter turn about z
  });
  edit("imu0/sensor.yaml", [](int, const std::string& line) {
    return line.find("         0, 1, 0, 0") == std::string::npos ? line : "         1, 0, 0, 0,";
  });
  const DatasetReader reader({.folder = folder_});
  const Pose T_rig_body{.R = exp_so3({0.0, 0.0, M_PI / 2}), .p = {0.5, 0.0, 0.0}};
  const Pose expected = inverse(T_rig_body) * calibration().T_body_cam0;
  EXPECT_LT(local_coordinates(reader.calibration().T_body_cam0, expected).norm(), 1e-12);
}

}  // namespace
}  // namespace fleetloc
