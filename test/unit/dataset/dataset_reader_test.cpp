#include "shared/dataset/dataset_reader.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "shared/dataset/dataset_writer.hpp"
#include "shared/geometry/so3.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr std::int64_t kStartNs = 1'403'636'579'758'555'392;  // more digits than a double holds

Timestamp at_ms(std::int64_t milliseconds) {
  return Timestamp(Duration(kStartNs) + std::chrono::milliseconds(milliseconds));
}

/// A gradient, so that JPEG changes it little; different for each frame and camera.
cv::Mat image_of(int number) {
  cv::Mat image(48, 64, CV_8U);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      image.at<std::uint8_t>(row, column) = static_cast<std::uint8_t>(row + column + 3 * number);
    }
  }
  return image;
}

ImuSample imu_sample(std::int64_t milliseconds) {
  const double t = 0.001 * static_cast<double>(milliseconds);
  return {.stamp = at_ms(milliseconds),
          .angular_velocity = {std::sin(t), std::cos(t), 1.0 / 3.0},
          .specific_force = {0.1 * t, -0.2, 9.81}};
}

StereoCalibration calibration() {
  Camera camera{.width_px = 64,
                .height_px = 48,
                .focal_px = {40.1, 1.0 / 0.03},
                .center_px = {31.5, 23.7},
                .distortion = Camera::Distortion::kEquidistant,
                .coefficients = {0.01, -0.02, 0.003, 1e-5}};
  const Pose T_body_cam0{.R = exp_so3({0.1, -0.2, 1.5}), .p = {0.01, -0.06, 0.02}};
  StereoCalibration stereo{
      .cam0 = camera, .cam1 = camera, .T_body_cam0 = T_body_cam0, .T_body_cam1 = T_body_cam0};
  stereo.T_body_cam1.p.x() += 0.11;
  stereo.cam1.distortion = Camera::Distortion::kRadialTangential;
  return stereo;
}

constexpr ImuNoise kNoise{.gyroscope_noise_density = 1.7e-4,
                          .gyroscope_random_walk = 1.9e-5,
                          .accelerometer_noise_density = 2e-3,
                          .accelerometer_random_walk = 3e-3};

/// Ten frames at 20 Hz from 100 ms on, IMU at 200 Hz from 0 to 700 ms.
class Dataset : public ::testing::Test {
 protected:
  Dataset() { std::filesystem::remove_all(folder_); }

  [[nodiscard]] DatasetWriter writer(ImageFormat format = ImageFormat::kPng) const {
    return DatasetWriter({.folder = folder_,
                          .calibration = calibration(),
                          .imu_noise = kNoise,
                          .frame_rate_hz = 20.0,
                          .imu_rate_hz = 200.0,
                          .format = format});
  }

  void write_all(ImageFormat format = ImageFormat::kPng) const {
    DatasetWriter dataset = writer(format);
    for (std::int64_t ms = 0; ms <= 700; ms += 5) dataset.add(imu_sample(ms));
    for (int i = 0; i < 10; ++i) dataset.add(frame(i));
    dataset.finish();
  }

  static StereoFrame frame(int number) {
    return {.stamp = at_ms(100 + 50 * number),
            .left = image_of(number),
            .right = image_of(number + 20)};
  }

  std::vector<DatasetReader::Item> play(DatasetReader::Options options = {}) {
    options.folder = folder_;
    DatasetReader reader(options);
    std::vector<DatasetReader::Item> items;
    while (auto item = reader.next()) items.push_back(std::move(*item));
    EXPECT_FALSE(reader.next());
    faults_ = reader.faults();
    return items;
  }

  static std::vector<StereoFrame> frames_of(const std::vector<DatasetReader::Item>& items) {
    std::vector<StereoFrame> frames;
    for (const auto& item : items) {
      if (const auto* frame = std::get_if<StereoFrame>(&item)) frames.push_back(*frame);
    }
    return frames;
  }

  std::string error_of_playing() {
    try {
      play();
    } catch (const DatasetError& error) {
      return error.what();
    }
    return "no error";
  }

  /// Changes a file of the dataset line by line; an empty result drops the line.
  void edit(const std::string& file,
            const std::function<std::string(int, const std::string&)>& edited) const {
    std::ifstream stream(folder_ / "mav0" / file);
    std::string text;
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
      const std::string replacement = edited(number, line);
      if (!replacement.empty()) text += replacement + "\n";
    }
    std::ofstream(folder_ / "mav0" / file) << text;
  }

  std::filesystem::path image_file(const char* camera, int number, const char* extension) const {
    const auto stamp = at_ms(100 + 50 * number).time_since_epoch().count();
    return folder_ / "mav0" / camera / "data" / (std::to_string(stamp) + extension);
  }

  const std::filesystem::path folder_ =
      test_folder() / "fleetloc_dataset" /
      ::testing::UnitTest::GetInstance()->current_test_info()->name();
  std::map<std::string, std::uint64_t> faults_;
};

Timestamp stamp_of(const DatasetReader::Item& item) {
  return std::visit([](const auto& value) { return value.stamp; }, item);
}

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
    if (std::holds_alternative<StereoFrame>(items[i])) {
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

TEST_F(Dataset, NamesFileAndLineOfAStampThatIsNotLater) {
  write_all();
  edit("imu0/data.csv", [](int number, const std::string& line) {
    return number == 40 ? std::to_string(kStartNs) + line.substr(19) : line;
  });
  EXPECT_THAT(error_of_playing(), HasSubstr("imu0/data.csv:40: the stamp is not later"));
}

TEST_F(Dataset, NamesFileAndLineOfALineThatIsCutOff) {
  write_all();
  edit("imu0/data.csv", [](int number, const std::string& line) {
    return number == 40 ? line.substr(0, 60) : line;
  });
  EXPECT_THAT(error_of_playing(), AllOf(HasSubstr("imu0/data.csv:40: "), HasSubstr("columns")));
}

TEST_F(Dataset, NamesFileAndLineOfAnUnsortedImageList) {
  write_all();
  edit("cam1/data.csv", [](int number, const std::string& line) {
    return number == 5 ? std::to_string(kStartNs) + line.substr(19) : line;
  });
  EXPECT_THAT(error_of_playing(), HasSubstr("cam1/data.csv:5: the stamp is not later"));
}

TEST_F(Dataset, NamesAListedImageThatDoesNotExist) {
  write_all();
  const auto image = image_file("cam0", 3, ".png");
  std::filesystem::remove(image);
  EXPECT_THAT(error_of_playing(),
              AllOf(HasSubstr("cam0/data.csv:5: "), HasSubstr(image.string() + ": no such image")));
}

TEST_F(Dataset, NamesAnImageThatIsCutOff) {
  for (const ImageFormat format : {ImageFormat::kPng, ImageFormat::kJpeg}) {
    std::filesystem::remove_all(folder_);
    write_all(format);
    const auto image = image_file("cam1", 3, format == ImageFormat::kPng ? ".png" : ".jpg");
    std::filesystem::resize_file(image, std::filesystem::file_size(image) * 2 / 3);
    EXPECT_THAT(error_of_playing(),
                AllOf(HasSubstr("cam1/data.csv:5: "), HasSubstr(image.string())));
  }
}

TEST_F(Dataset, NamesAnImageOfAnotherSize) {
  write_all();
  edit("cam0/sensor.yaml", [](int, const std::string& line) {
    return line.starts_with("resolution") ? std::string("resolution: [64, 50]") : line;
  });
  EXPECT_THAT(error_of_playing(), HasSubstr("has 64x48 pixels instead of the sensor's 64x50"));
}

TEST_F(Dataset, NamesAFolderThatIsNoDataset) {
  std::filesystem::create_directories(folder_);
  EXPECT_THAT(error_of_playing(), HasSubstr(folder_.string() + ": not a dataset"));
}

TEST_F(Dataset, NamesAMissingFile) {
  write_all();
  std::filesystem::remove(folder_ / "mav0" / "imu0" / "data.csv");
  EXPECT_THAT(error_of_playing(), HasSubstr("imu0/data.csv: no such file"));
  std::filesystem::remove_all(folder_);
  write_all();
  std::filesystem::remove(folder_ / "mav0" / "cam1" / "sensor.yaml");
  EXPECT_THAT(error_of_playing(), HasSubstr("cam1/sensor.yaml: cannot be read"));
}

}  // namespace
}  // namespace fleetloc
