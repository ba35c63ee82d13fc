#include "shared/ros2/ros2_fields.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <limits>

namespace fleetloc {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;
constexpr std::size_t kMaxText = 256;
constexpr double kMaxCoordinate_m = 1e8;  // geocentric ones still fit
constexpr double kNormTolerance = 1e-2;   // of quaternions, which some publish in single precision

}  // namespace

builtin_interfaces::msg::dds_::Time_ to_ros2(Timestamp stamp) {
  constexpr std::int64_t kLast =
      std::int64_t{std::numeric_limits<std::int32_t>::max()} * kNsPerSecond + kNsPerSecond - 1;
  const std::int64_t ns = std::clamp(stamp.time_since_epoch().count(), std::int64_t{0}, kLast);
  builtin_interfaces::msg::dds_::Time_ time;
  time.sec(static_cast<std::int32_t>(ns / kNsPerSecond));
  time.nanosec(static_cast<std::uint32_t>(ns % kNsPerSecond));
  return time;
}

std_msgs::msg::dds_::Header_ to_ros2(const Ros2Header& header) {
  std_msgs::msg::dds_::Header_ message;
  message.stamp(to_ros2(header.stamp));
  message.frame_id(header.frame);
  return message;
}

geometry_msgs::msg::dds_::Vector3_ to_ros2(const Eigen::Vector3d& vector) {
  geometry_msgs::msg::dds_::Vector3_ message;
  message.x(vector.x());
  message.y(vector.y());
  message.z(vector.z());
  return message;
}

geometry_msgs::msg::dds_::Quaternion_ to_ros2(const Eigen::Quaterniond& rotation) {
  geometry_msgs::msg::dds_::Quaternion_ message;
  message.x(rotation.x());
  message.y(rotation.y());
  message.z(rotation.z());
  message.w(rotation.w());
  return message;
}

geometry_msgs::msg::dds_::Pose_ to_ros2(const Pose& T) {
  geometry_msgs::msg::dds_::Pose_ message;
  message.position().x(T.p.x());
  message.position().y(T.p.y());
  message.position().z(T.p.z());
  message.orientation(to_ros2(T.R));
  return message;
}

Ros2Header from_ros2(const std_msgs::msg::dds_::Header_& header) {
  const Duration since_1970 = std::chrono::seconds(header.stamp().sec()) +
                              std::chrono::nanoseconds(header.stamp().nanosec());
  return {.stamp = Timestamp(since_1970), .frame = header.frame_id()};
}

Eigen::Vector3d from_ros2(const geometry_msgs::msg::dds_::Vector3_& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Pose from_ros2(const geometry_msgs::msg::dds_::Pose_& pose) {
  const auto& q = pose.orientation();
  const auto& p = pose.position();
  return {.R = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized(),
          .p = {p.x(), p.y(), p.z()}};
}

Ros2Validity check(const std_msgs::msg::dds_::Header_& header) {
  const bool is_time = header.stamp().sec() >= 0 && header.stamp().nanosec() < kNsPerSecond;
  if (!is_time) return unexpected(Ros2Refusal::kInvalidStamp);
  return check_text(header.frame_id());
}

Ros2Validity check_text(const std::string& text) {
  if (text.size() > kMaxText) return unexpected(Ros2Refusal::kLongText);
  return {};
}

Ros2Validity check_finite(std::span<const double> values) {
  const bool finite =
      std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  if (!finite) return unexpected(Ros2Refusal::kNotFinite);
  return {};
}

Ros2Validity check(const geometry_msgs::msg::dds_::Vector3_& vector, double max) {
  const std::array<double, 3> values{vector.x(), vector.y(), vector.z()};
  if (const Ros2Validity valid = check_finite(values); !valid) return valid;
  if (!(from_ros2(vector).norm() <= max)) return unexpected(Ros2Refusal::kOutOfRange);
  return {};
}

Ros2Validity check(const geometry_msgs::msg::dds_::Pose_& pose) {
  const auto& q = pose.orientation();
  const auto& p = pose.position();
  const std::array<double, 7> values{p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
  if (const Ros2Validity valid = check_finite(values); !valid) return valid;
  const bool is_near = Eigen::Vector3d(p.x(), p.y(), p.z()).norm() <= kMaxCoordinate_m;
  if (!is_near) return unexpected(Ros2Refusal::kOutOfRange);
  const double norm = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).norm();
  if (!(std::abs(norm - 1.0) <= kNormTolerance)) return unexpected(Ros2Refusal::kNotARotation);
  return {};
}

}  // namespace fleetloc
