#include <functional>

#include "shared/ros2/pixel_encoding.hpp"
#include "test/unit/ros2/samples.hpp"

namespace fleetloc {
namespace {

using sensor_msgs::msg::dds_::Image_;

void expect_image_refused(std::string_view reason, const std::function<void(Image_&)>& corrupt) {
  Image_ image = raw_image(4, 3, "mono8", std::vector<std::uint8_t>(12, 9));
  corrupt(image);
  expect_refused(decode_image(to_cdr(image)), reason);
}

cv::Mat decoded(const Image_& image) {
  return decode_image(to_cdr(image)).value().gray;
}

TEST(Ros2Image, RoundTripPreservesEveryField) {
  const ImageMessage sent = some_image();
  const ImageMessage received = decode_image(encode(sent)).value();
  EXPECT_EQ(received.header.stamp, sent.header.stamp);
  EXPECT_EQ(received.header.frame, sent.header.frame);
  EXPECT_TRUE(same_pixels(received.gray, sent.gray));
}

TEST(Ros2Image, APartOfAnImageIsWrittenWithoutTheRest) {
  ImageMessage part = some_image(9, 6);
  part.gray = part.gray(cv::Rect(2, 1, 4, 3));
  ASSERT_FALSE(part.gray.isContinuous());
  EXPECT_TRUE(same_pixels(decode_image(encode(part)).value().gray, part.gray));
}

TEST(Ros2Image, UnknownEncodingsAreRefused) {
  for (const char* encoding : {"", "yuv422", "MONO8", "rgba8", "32FC1", "bayer_rggb16"}) {
    expect_image_refused("unknown_encoding", [&](Image_& image) { image.encoding(encoding); });
  }
}

TEST(Ros2Image, ARowShorterThanItsPixelsIsRefused) {
  expect_image_refused("wrong_step", [](Image_& image) { image.step(3); });
  expect_image_refused("wrong_step", [](Image_& image) { image.encoding("mono16"); });
  expect_image_refused("wrong_step", [](Image_& image) { image.encoding("rgb8"); });
}

TEST(Ros2Image, DataOfAnotherLengthThanItsRowsAreRefused) {
  expect_image_refused("wrong_length", [](Image_& image) { image.data().resize(11); });
  expect_image_refused("wrong_length", [](Image_& image) { image.data().resize(13); });
  expect_image_refused("wrong_length", [](Image_& image) { image.data().clear(); });
  // 2^32: would be 0 in 32 bits.
  expect_image_refused("wrong_length", [](Image_& image) {
    image.height(65'536);
    image.step(65'536);
    image.data().clear();
  });
}

TEST(Ros2Image, AbsurdSizesAreRefused) {
  expect_image_refused("too_many_pixels", [](Image_& image) {
    image.width(0xFFFF'FFFF);
    image.height(0xFFFF'FFFF);
  });
  expect_image_refused("too_many_pixels", [](Image_& image) { image.width(64'000'001); });
  expect_image_refused("too_many_pixels", [](Image_& image) { image.height(0x8000'0000); });
}

TEST(Ros2Image, AnImageWithoutPixelsIsRefused) {
  expect_image_refused("empty_image", [](Image_& image) { image.width(0); });
  expect_image_refused("empty_image", [](Image_& image) { image.height(0); });
}

TEST(Ros2Image, AnUnknownByteOrderIsRefused) {
  expect_image_refused("wrong_order", [](Image_& image) { image.is_bigendian(2); });
}

TEST(Ros2Image, AHeaderThatIsNotValidIsRefused) {
  expect_image_refused("invalid_stamp", [](Image_& image) { image.header().stamp().sec(-1); });
  expect_image_refused("long_text",
                       [](Image_& image) { image.header().frame_id(std::string(257, 'a')); });
}

TEST(Ros2Image, BytesBehindTheRowsPixelsAreLeftOut) {
  const Image_ image = raw_image(2, 2, "mono8", {1, 2, 99, 3, 4, 99});
  EXPECT_TRUE(same_pixels(decoded(image), (cv::Mat_<std::uint8_t>(2, 2) << 1, 2, 3, 4)));
}

TEST(Ros2Image, RgbAndBgrDifferInTheOrderOfTheirColors) {
  // Rec. 601: red counts 0.299, green 0.587, blue 0.114.
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(1, 3) << 76, 150, 29);
  const cv::Mat rgb = decoded(raw_image(3, 1, "rgb8", {255, 0, 0, 0, 255, 0, 0, 0, 255}));
  const cv::Mat bgr = decoded(raw_image(3, 1, "bgr8", {0, 0, 255, 0, 255, 0, 255, 0, 0}));
  EXPECT_TRUE(same_pixels(rgb, expected));
  EXPECT_TRUE(same_pixels(bgr, expected));
}

TEST(Ros2Image, OfSixteenBitsTheUpperEightAreTaken) {
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(2, 2) << 0x12, 0xff, 0x56, 0x00);
  for (const char* encoding : {"mono16", "16UC1"}) {
    // Rows of an odd number of bytes: pixels of the second row are not aligned.
    Image_ image = raw_image(2, 2, encoding, {0x34, 0x12, 0, 0xff, 9, 0x78, 0x56, 0xee, 0x00, 9});
    EXPECT_TRUE(same_pixels(decoded(image), expected)) << encoding;
    image.data({0x12, 0x34, 0xff, 0, 9, 0x56, 0x78, 0x00, 0xee, 9});
    image.is_bigendian(1);
    EXPECT_TRUE(same_pixels(decoded(image), expected)) << encoding;
  }
}

TEST(Ros2Image, GrayOutlivesTheMessage) {
  std::vector<std::uint8_t> data{1, 2, 3, 4};
  const auto gray =
      to_gray({.width_px = 2, .height_px = 2, .step = 2, .byte_order = 0, .data = data}, "8UC1");
  data.assign(4, 0);
  EXPECT_TRUE(same_pixels(gray.value(), (cv::Mat_<std::uint8_t>(2, 2) << 1, 2, 3, 4)));
}

}  // namespace
}  // namespace fleetloc
