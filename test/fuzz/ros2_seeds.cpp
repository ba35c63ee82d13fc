#include <opencv2/imgcodecs.hpp>

#include "test/fuzz/seeds.hpp"
#include "test/unit/ros2/samples.hpp"

namespace fleetloc {
namespace {

void add_raw_image(const SeedFolder& seeds, const std::string& encoding, std::size_t pixel_bytes) {
  const auto raw = raw_image(4, 4, encoding, std::vector<std::uint8_t>(16 * pixel_bytes, 90));
  seeds.add("net_ros2_image", encoding, to_cdr(raw));
}

}  // namespace

void add_ros2_seeds(const SeedFolder& seeds) {
  seeds.add("net_ros2_image", "encoded", encode(some_image()));
  for (const char* gray : {"mono8", "8UC1", "bayer_rggb8", "bayer_gbrg8"}) {
    add_raw_image(seeds, gray, 1);
  }
  for (const char* deep : {"mono16", "16UC1"}) add_raw_image(seeds, deep, 2);
  for (const char* color : {"rgb8", "bgr8"}) add_raw_image(seeds, color, 3);
  for (const char* kind : {"png", "jpg"}) {
    std::vector<std::uint8_t> file;
    cv::imencode(std::string(".") + kind, some_image(16, 16).gray, file);
    seeds.add("file_image", kind, file);
    sensor_msgs::msg::dds_::CompressedImage_ message;
    message.header(to_ros2(some_header()));
    message.format(kind);
    message.data(file);
    seeds.add("net_ros2_compressed_image", kind, to_cdr(message));
  }
  std::vector<std::uint8_t> progressive;
  cv::imencode(".jpg", some_image(16, 16).gray, progressive, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  seeds.add("file_image", "progressive", progressive);
  seeds.add("net_ros2_imu", "some", encode(some_imu()));
  seeds.add("net_ros2_camera_info", "some", encode(some_camera_info()));
  seeds.add("net_ros2_pose", "some", encode(some_pose_message()));
}

}  // namespace fleetloc
