#include "shared/ros2/point_cloud_codec.hpp"

#include <bit>
#include <cstring>

#include <idl/ros2/sensor_msgs.h>

#include "shared/ros2/ros2_cdr.hpp"
#include "shared/ros2/ros2_fields.hpp"

namespace fleetloc {
namespace {

constexpr std::uint32_t kCoordinateBytes = sizeof(float);
constexpr std::uint32_t kPointBytes = 3 * kCoordinateBytes;
static_assert(std::endian::native == std::endian::little,
              "points are copied as they lie in memory");
static_assert(sizeof(Eigen::Vector3f) == kPointBytes);

sensor_msgs::msg::dds_::PointField_ coordinate(const char* name, std::uint32_t offset) {
  constexpr std::uint8_t kFloat32 = 7;
  sensor_msgs::msg::dds_::PointField_ field;
  field.name(name);
  field.offset(offset);
  field.datatype(kFloat32);
  field.count(1);
  return field;
}

}  // namespace

Bytes encode(const PointCloudMessage& message) {
  sensor_msgs::msg::dds_::PointCloud2_ cloud;
  cloud.header(to_ros2(message.header));
  cloud.height(1);
  cloud.width(static_cast<std::uint32_t>(message.points.size()));
  cloud.fields({coordinate("x", 0),
                coordinate("y", kCoordinateBytes),
                coordinate("z", 2 * kCoordinateBytes)});
  cloud.is_bigendian(false);
  cloud.point_step(kPointBytes);
  cloud.row_step(kPointBytes * cloud.width());
  cloud.is_dense(true);
  cloud.data().resize(cloud.row_step());
  if (!message.points.empty()) {
    std::memcpy(cloud.data().data(), message.points.data(), cloud.data().size());
  }
  return to_cdr(cloud);
}

}  // namespace fleetloc
