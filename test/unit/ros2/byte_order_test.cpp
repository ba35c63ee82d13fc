#include <bit>
#include <cstring>

#include "test/unit/ros2/samples.hpp"

// Bytes written by the rules of CDR, not by the library: whatever ROS 2 sends looks like this.
// Values are aligned to their size, counted from behind the encapsulation.
namespace fleetloc {
namespace {

// 2.5 s after 1970.
constexpr std::int64_t kStamp_ns = 2'500'000'000;

/// 2 x 2 pixels, rows of 3 bytes.
const Bytes kLittleEndianImage{
    0x00, 0x01, 0x00, 0x00,                          // encapsulation: CDR, little endian
    0x02, 0x00, 0x00, 0x00,                          // 0: seconds
    0x00, 0x65, 0xcd, 0x1d,                          // 4: nanoseconds
    0x03, 0x00, 0x00, 0x00, 'l',  'r',  0x00, 0x00,  // 8: frame "lr" with its end, 1 byte to fill
    0x02, 0x00, 0x00, 0x00,                          // 16: height
    0x02, 0x00, 0x00, 0x00,                          // 20: width
    0x06, 0x00, 0x00, 0x00, 'm',  'o',  'n',  'o',  '8',  0x00,   // 24: encoding
    0x00, 0x00,                                                   // 34: byte order, 1 byte to fill
    0x03, 0x00, 0x00, 0x00,                                       // 36: step
    0x06, 0x00, 0x00, 0x00, 0x0a, 0x14, 0xff, 0x1e, 0x28, 0xff};  // 40: data

const Bytes kBigEndianImage{0x00, 0x00, 0x00, 0x00,  // encapsulation: CDR, big endian
                            0x00, 0x00, 0x00, 0x02,  // seconds
                            0x1d, 0xcd, 0x65, 0x00,  // nanoseconds
                            0x00, 0x00, 0x00, 0x03, 'l',  'r',  0x00, 0x00,              // frame
                            0x00, 0x00, 0x00, 0x02,                                      // height
                            0x00, 0x00, 0x00, 0x02,                                      // width
                            0x00, 0x00, 0x00, 0x06, 'm',  'o',  'n',  'o',  '8',  0x00,  // encoding
                            0x00, 0x00,              // byte order
                            0x00, 0x00, 0x00, 0x03,  // step
                            0x00, 0x00, 0x00, 0x06, 0x0a, 0x14, 0xff, 0x1e, 0x28, 0xff};  // data

void expect_the_image(const Bytes& bytes) {
  const auto image = decode_image(bytes);
  ASSERT_TRUE(image.has_value()) << name(image.error());
  EXPECT_EQ(image->header.stamp, Timestamp(Duration(kStamp_ns)));
  EXPECT_EQ(image->header.frame, "lr");
  EXPECT_TRUE(same_pixels(image->gray, (cv::Mat_<std::uint8_t>(2, 2) << 10, 20, 30, 40)));
}

void append(Bytes& bytes, double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<std::uint8_t>(bits >> (8 * i)));
}

/// All doubles of the IMU stand behind one another, the first at 16.
Bytes imu_bytes() {
  Bytes bytes{0x00, 0x01, 0x00, 0x00, 0x02, 0x00, 0x00, 0x00, 0x00, 0x65,
              0xcd, 0x1d, 0x04, 0x00, 0x00, 0x00, 'i',  'm',  'u',  0x00};
  for (const double q : {0.0, 0.0, 0.0, 1.0}) append(bytes, q);
  append(bytes, -1.0);  // no orientation
  for (int i = 0; i < 8; ++i) append(bytes, 0.0);
  for (const double w : {0.1, -0.2, 0.3}) append(bytes, w);
  for (int i = 0; i < 9; ++i) append(bytes, 0.0);
  for (const double f : {-1.5, 0.25, 9.75}) append(bytes, f);
  for (int i = 0; i < 9; ++i) append(bytes, 0.0);
  return bytes;
}

TEST(Ros2Bytes, AnImageIsReadInLittleEndian) {
  expect_the_image(kLittleEndianImage);
}

TEST(Ros2Bytes, AnImageIsReadInBigEndian) {
  expect_the_image(kBigEndianImage);
}

TEST(Ros2Bytes, AnImageIsWrittenAsTheRulesSay) {
  const ImageMessage image{.header = {.stamp = Timestamp(Duration(kStamp_ns)), .frame = "lr"},
                           .gray = (cv::Mat_<std::uint8_t>(2, 3) << 10, 20, 255, 30, 40, 255)};
  Bytes expected = kLittleEndianImage;
  expected[24] = 3;  // width
  EXPECT_EQ(encode(image), expected);
}

TEST(Ros2Bytes, AnImuIsWrittenAsTheRulesSay) {
  ImuMessage imu = some_imu();
  imu.sample.stamp = Timestamp(Duration(kStamp_ns));
  EXPECT_EQ(encode(imu), imu_bytes());
}

TEST(Ros2Bytes, AnImuIsReadAsTheRulesSay) {
  const auto imu = decode_imu(imu_bytes());
  ASSERT_TRUE(imu.has_value()) << name(imu.error());
  EXPECT_EQ(imu->frame, "imu");
  EXPECT_EQ(imu->sample.stamp, Timestamp(Duration(kStamp_ns)));
  EXPECT_EQ(imu->sample.angular_velocity, Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_EQ(imu->sample.specific_force, Eigen::Vector3d(-1.5, 0.25, 9.75));
}

TEST(Ros2Bytes, PaddingOfUpToThreeBytesMayFollow) {
  Bytes bytes = imu_bytes();
  bytes.insert(bytes.end(), 3, 0);
  EXPECT_TRUE(decode_imu(bytes).has_value());
  bytes.push_back(0);
  expect_refused(decode_imu(bytes), "undecodable");
}

TEST(Ros2Bytes, OtherEncapsulationsAreRefused) {
  Bytes bytes = imu_bytes();
  bytes[1] = 0x03;  // parameter list
  expect_refused(decode_imu(bytes), "undecodable");
}

TEST(Ros2Bytes, EveryTruncationIsRefused) {
  const auto expect_cuts_refused = [](const Bytes& bytes, auto decode) {
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      // Memory of its own, so that a sanitizer sees reads behind it.
      const Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(length));
      EXPECT_NO_THROW(expect_refused(decode(cut), "undecodable")) << length;
    }
  };
  expect_cuts_refused(encode(some_imu()), decode_imu);
  expect_cuts_refused(encode(some_image()), decode_image);
  expect_cuts_refused(kBigEndianImage, decode_image);
  expect_cuts_refused(encode(some_camera_info()), decode_camera_info);
  expect_cuts_refused(encode(some_pose_message()), decode_pose);
}

}  // namespace
}  // namespace fleetloc
