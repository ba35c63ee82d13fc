// Files that cannot be played: the error names file and line.
#include <fstream>

#include <gmock/gmock.h>

#include "test/unit/dataset/written_dataset.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

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
