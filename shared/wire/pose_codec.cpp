#include "shared/wire/pose_codec.hpp"

#include <idl/pose.h>

#include "shared/wire/cdr.hpp"
#include "shared/wire/fields.hpp"
#include "shared/wire/quality.hpp"

namespace fleetloc {
namespace {

constexpr double kMaxSpeed_mps = 1e4;
constexpr double kMaxTurnRate_radps = 1e3;

Validity check_pose_sample(const wire::PoseEstimate& sample) {
  if (const Validity valid = check(sample.quality()); !valid) return valid;
  if (const Validity valid = check_stamp(sample.stamp_ns()); !valid) return valid;
  if (const Validity valid = check_stamp(sample.since_last_answer_ns()); !valid) return valid;
  for (const wire::Pose& T : {sample.T_odom_body(), sample.T_map_body()}) {
    if (const Validity valid = check(T); !valid) return valid;
  }
  for (const wire::SquareRoot6& covariance : {sample.covariance_odom(), sample.covariance_map()}) {
    if (const Validity valid = check(covariance); !valid) return valid;
  }
  if (const Validity valid = check(sample.v_odom(), kMaxSpeed_mps); !valid) return valid;
  return check(sample.angular_velocity(), kMaxTurnRate_radps);
}

}  // namespace

Bytes encode(const RobotPoseEstimate& pose) {
  expect_encodable_id(pose.robot);
  const PoseEstimate& estimate = pose.estimate;
  wire::PoseEstimate sample;
  sample.robot(pose.robot);
  sample.stamp_ns(to_wire(estimate.stamp));
  sample.quality(to_wire(estimate.quality));
  sample.since_last_answer_ns(estimate.since_last_answer.count());
  sample.T_odom_body(to_wire(estimate.T_odom_body));
  sample.covariance_odom(to_wire(estimate.covariance_odom));
  sample.has_map_pose(estimate.T_map_body.has_value());
  sample.T_map_body(to_wire(estimate.T_map_body.value_or(Pose{})));
  if (estimate.T_map_body) sample.covariance_map(to_wire(estimate.covariance_map));
  sample.v_odom(to_wire(estimate.v_odom));
  sample.angular_velocity(to_wire(estimate.angular_velocity));
  expect_encodable(check_pose_sample(sample), "pose estimate");
  return to_cdr(sample);
}

Decoded<RobotPoseEstimate> decode_pose_estimate(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::PoseEstimate>(bytes, 1, check_pose_sample);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  PoseEstimate estimate{.stamp = stamp_from_wire(sample.stamp_ns()),
                        .quality = from_wire(sample.quality()),
                        .since_last_answer = Duration{sample.since_last_answer_ns()},
                        .T_odom_body = from_wire(sample.T_odom_body()),
                        .covariance_odom = from_wire(sample.covariance_odom()),
                        .T_map_body = std::nullopt,
                        .covariance_map = from_wire(sample.covariance_map()),
                        .v_odom = from_wire(sample.v_odom()),
                        .angular_velocity = from_wire(sample.angular_velocity())};
  if (sample.has_map_pose()) estimate.T_map_body = from_wire(sample.T_map_body());
  return RobotPoseEstimate{.robot = sample.robot().to_string(), .estimate = estimate};
}

}  // namespace fleetloc
