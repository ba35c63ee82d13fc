#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "test/unit/ros2/samples.hpp"

namespace fleetloc {
namespace {

using File = std::vector<std::uint8_t>;

Bytes message_with(const File& file) {
  sensor_msgs::msg::dds_::CompressedImage_ message;
  message.header(to_ros2(some_header()));
  message.format("whatever");
  message.data(file);
  return to_cdr(message);
}

File file_of(const cv::Mat& image, const char* extension) {
  File file;
  cv::imencode(extension, image, file);
  return file;
}

TEST(Ros2CompressedImage, APngIsReadExactly) {
  const ImageMessage image = some_image(33, 20);
  const auto received = decode_compressed_image(message_with(file_of(image.gray, ".png"))).value();
  EXPECT_EQ(received.header.stamp, some_header().stamp);
  EXPECT_EQ(received.header.frame, some_header().frame);
  EXPECT_TRUE(same_pixels(received.gray, image.gray));
}

TEST(Ros2CompressedImage, AJpegIsReadNearly) {
  const cv::Mat gray(24, 40, CV_8UC1, cv::Scalar(120));
  const cv::Mat received =
      decode_compressed_image(message_with(file_of(gray, ".jpg"))).value().gray;
  ASSERT_EQ(received.size(), gray.size());
  EXPECT_LE(cv::norm(received, gray, cv::NORM_INF), 2.0);
}

TEST(Ros2CompressedImage, WhatIsSentAsJpegIsReadNearly) {
  ImageMessage sent{.header = some_header(), .gray = cv::Mat(24, 40, CV_8UC1, cv::Scalar(60))};
  cv::rectangle(sent.gray, {8, 8}, {23, 15}, cv::Scalar(200), cv::FILLED);  // of whole JPEG blocks
  const auto received = decode_compressed_image(encode_as_jpeg(sent, 95)).value();
  EXPECT_EQ(received.header.stamp, sent.header.stamp);
  EXPECT_EQ(received.header.frame, sent.header.frame);
  ASSERT_EQ(received.gray.size(), sent.gray.size());
  EXPECT_LE(cv::norm(received.gray, sent.gray, cv::NORM_INF), 2.0);
}

TEST(Ros2CompressedImage, OtherFilesAreRefused) {
  const File bmp = file_of(some_image().gray, ".bmp");
  for (const File& file : {File{}, File{0xff}, File(100, 0), bmp}) {
    expect_refused(decode_compressed_image(message_with(file)), "unknown_encoding");
  }
}

TEST(Ros2CompressedImage, ACutJpegIsRefused) {
  const File file = file_of(some_image(64, 64).gray, ".jpg");
  for (std::size_t length = 3; length < file.size(); ++length) {
    const File cut(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length));
    expect_refused(decode_compressed_image(message_with(cut)), "damaged_image");
  }
}

/// The file with a smaller one in a segment of its own, as cameras have it in Exif.
File with_thumbnail(const File& file, const File& thumbnail) {
  const std::size_t length = 2 + thumbnail.size();
  File whole{0xff, 0xd8, 0xff, 0xe1};
  whole.push_back(static_cast<std::uint8_t>(length >> 8U));
  whole.push_back(static_cast<std::uint8_t>(length));
  whole.insert(whole.end(), thumbnail.begin(), thumbnail.end());
  whole.insert(whole.end(), file.begin() + 2, file.end());
  return whole;
}

TEST(Ros2CompressedImage, TheEndOfAThumbnailIsNotThatOfTheJpeg) {
  const File thumbnail = file_of(some_image(16, 16).gray, ".jpg");
  const File file = with_thumbnail(file_of(some_image(64, 64).gray, ".jpg"), thumbnail);
  EXPECT_EQ(decode_compressed_image(message_with(file)).value().gray.size(), cv::Size(64, 64));
  for (std::size_t length = 6 + thumbnail.size(); length < file.size(); ++length) {
    const File cut(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(length));
    expect_refused(decode_compressed_image(message_with(cut)), "damaged_image");
  }
}

TEST(Ros2CompressedImage, ASizeIsRefusedBeforeItIsDecoded) {
  File png = file_of(some_image().gray, ".png");
  png[16] = 0x7f;  // the highest byte of its width
  expect_refused(decode_compressed_image(message_with(png)), "too_many_pixels");
  std::fill(png.begin() + 16, png.begin() + 20, std::uint8_t{0});
  expect_refused(decode_compressed_image(message_with(png)), "empty_image");
}

}  // namespace
}  // namespace fleetloc
