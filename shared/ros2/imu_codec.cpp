#include "shared/ros2/imu_codec.hpp"

#include <idl/ros2/sensor_msgs.h>

#include "shared/ros2/ros2_cdr.hpp"
#include "shared/ros2/ros2_fields.hpp"

namespace fleetloc {
namespace {

using sensor_msgs::msg::dds_::Imu_;

constexpr double kMaxTurnRate_radps = 1e3;
constexpr double kMaxForce_mps2 = 1e4;
constexpr double kNoSuchMeasurement = -1.0;  // as the first element of its covariance

bool is_measured(const std::array<double, 9>& covariance) {
  return covariance.front() != kNoSuchMeasurement;
}

Ros2Validity check_imu_message(const Imu_& message) {
  if (const Ros2Validity valid = check(message.header()); !valid) return valid;
  const bool measured = is_measured(message.angular_velocity_covariance()) &&
                        is_measured(message.linear_acceleration_covariance());
  if (!measured) return unexpected(Ros2Refusal::kNotMeasured);
  if (const Ros2Validity valid = check(message.angular_velocity(), kMaxTurnRate_radps); !valid) {
    return valid;
  }
  return check(message.linear_acceleration(), kMaxForce_mps2);
}

}  // namespace

Bytes encode(const ImuMessage& message) {
  Imu_ imu;
  imu.header(to_ros2(Ros2Header{message.sample.stamp, message.frame}));
  imu.orientation(to_ros2(Eigen::Quaterniond::Identity()));
  imu.orientation_covariance({kNoSuchMeasurement});
  imu.angular_velocity(to_ros2(message.sample.angular_velocity));
  imu.angular_velocity_covariance({});
  imu.linear_acceleration(to_ros2(message.sample.specific_force));
  imu.linear_acceleration_covariance({});
  return to_cdr(imu);
}

Ros2Decoded<ImuMessage> decode_imu(std::span<const std::uint8_t> bytes) {
  const auto imu = from_ros2_cdr<Imu_>(bytes);
  if (!imu) return unexpected(imu.error());
  if (const Ros2Validity valid = check_imu_message(*imu); !valid) return unexpected(valid.error());
  const Ros2Header header = from_ros2(imu->header());
  return ImuMessage{.frame = header.frame,
                    .sample = {.stamp = header.stamp,
                               .angular_velocity = from_ros2(imu->angular_velocity()),
                               .specific_force = from_ros2(imu->linear_acceleration())}};
}

}  // namespace fleetloc
