#include "shared/wire/pose_codec.hpp"

#include <idl/pose.h>

#include "shared/wire/cdr.hpp"
#include "shared/wire/fields.hpp"
#include "shared/wire/quality.hpp"

namespace fleetloc {
namespace {

constexpr double kMaxSpeed_mps = 1e4;
constexpr double kMaxTurnRate_radps = 1e3;

Defect defect_of_sample(const wire::PoseEstimate& sample) {
  if (const Defect found = defect(sample.quality())) return found;
  if (const Defect found = defect_of_stamp(sample.stamp_ns())) return found;
  if (const Defect found = defect_of_stamp(sample.since_last_answer_ns())) return found;
  for (const wire::Pose& T : {sample.T_odom_body(), sample.T_map_body()}) {
    if (const Defect found = defect(T)) return found;
  }
  for (const wire::SquareRoot6& covariance : {sample.covariance_odom(), sample.covariance_map()}) {
    if (const Defect found = defect(covariance)) return found;
  }
  if (const Defect found = defect(sample.v_odom(), kMaxSpeed_mps)) return found;
  return defect(sample.angular_velocity(), kMaxTurnRate_radps);
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
  expect_encodable(defect_of_sample(sample), "pose estimate");
  return to_cdr(sample);
}

Decoded<RobotPoseEstimate> decode_pose_estimate(std::span<const std::uint8_t> bytes) {
  const auto decoded = from_cdr<wire::PoseEstimate>(bytes, 1);
  if (const auto* reason = std::get_if<Malformed>(&decoded)) return *reason;
  const auto& sample = std::get<wire::PoseEstimate>(decoded);
  if (const Defect found = defect_of_sample(sample)) return *found;
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
