#include <random>

#include <opencv2/imgcodecs.hpp>

#include "test/unit/ros2/samples.hpp"

// What a faulty driver, a bad link or an attacker could send: nothing may throw or crash.
namespace fleetloc {
namespace {

constexpr int kFlips = 20'000;

/// One to four bits of `seed` flipped. Returns how many were accepted.
template <typename Decode>
int fuzz(const Bytes& seed, Decode decode) {
  std::mt19937 random(7);
  int accepted = 0;
  for (int trial = 0; trial < kFlips; ++trial) {
    Bytes bytes = seed;
    const int flips = 1 + static_cast<int>(random() % 4);
    for (int i = 0; i < flips; ++i) {
      bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << (random() % 8));
    }
    EXPECT_NO_THROW(accepted += decode(bytes).has_value() ? 1 : 0) << trial;
  }
  return accepted;
}

TEST(Ros2Fuzz, ImagesAreRefusedOrDecoded) {
  EXPECT_GT(fuzz(encode(some_image()), decode_image), 0);
}

TEST(Ros2Fuzz, BayerImagesAreRefusedOrDecoded) {
  const auto raw = raw_image(4, 4, "bayer_rggb8", std::vector<std::uint8_t>(16, 90));
  EXPECT_GT(fuzz(to_cdr(raw), decode_image), 0);
}

TEST(Ros2Fuzz, ImusAreRefusedOrDecoded) {
  EXPECT_GT(fuzz(encode(some_imu()), decode_imu), 0);
}

TEST(Ros2Fuzz, CameraInfosAreRefusedOrDecoded) {
  EXPECT_GT(fuzz(encode(some_camera_info()), decode_camera_info), 0);
}

TEST(Ros2Fuzz, PosesAreRefusedOrDecoded) {
  EXPECT_GT(fuzz(encode(some_pose_message()), decode_pose), 0);
}

TEST(Ros2Fuzz, CompressedImagesAreRefusedOrDecoded) {
  for (const char* extension : {".png", ".jpg"}) {
    sensor_msgs::msg::dds_::CompressedImage_ message;
    message.header(to_ros2(some_header()));
    cv::imencode(extension, some_image(16, 16).gray, message.data());
    EXPECT_GT(fuzz(to_cdr(message), decode_compressed_image), 0) << extension;
  }
}

}  // namespace
}  // namespace fleetloc
