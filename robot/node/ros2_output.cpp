#include "robot/node/ros2_output.hpp"

#include <utility>

#include "robot/node/ros2_poses.hpp"
#include "shared/ros2/ros2_names.hpp"

namespace fleetloc {
namespace {

Ros2Topic reliable(const std::string& name, const char* type) {
  return {.name = dds_name(RosTopic{.name = name}), .type = type, .qos = Ros2Qos::kDefault};
}

}  // namespace

Rate::Rate(double rate_hz) {
  if (rate_hz > 0.0) interval_ = from_seconds(1.0 / rate_hz);
}

bool Rate::is_due(Timestamp stamp) {
  if (!interval_) return false;
  const bool is_late = !next_ || stamp >= *next_ + *interval_;
  const bool was_set_back = next_ && stamp < *next_ - *interval_;
  if (next_ && stamp < *next_ && !was_set_back) return false;
  next_ = (is_late || was_set_back ? stamp : *next_) + *interval_;
  return true;
}

Ros2Output::Ros2Output(const SensorsConfig& config, Ros2Participant& participant)
    : frames_(config.frames),
      odometry_rate_(config.output.odometry_rate_hz),
      odom_base_rate_(config.output.odom_base_tf_rate_hz),
      map_odom_rate_(config.output.map_odom_tf_rate_hz),
      odometry_(
          participant.create_writer(reliable(config.output.odometry_topic, ros2_type::kOdometry))),
      map_pose_(participant.create_writer(
          reliable(config.output.map_pose_topic, ros2_type::kPoseWithCovariance))),
      tf_(participant.create_writer(reliable("/tf", ros2_type::kTransforms))) {}

void Ros2Output::add(const RobotOutput& output) {
  if (output.pose && output.pose->quality != Quality::kInitializing) publish(*output.pose);
  for (const FrameOutput& frame : output.frames) {
    if (!frame.pose.T_map_body) continue;
    write(map_pose_, encode(map_pose_message(frame.pose, frames_)));
  }
}

void Ros2Output::publish(const PoseEstimate& pose) {
  if (odometry_rate_.is_due(pose.stamp)) write(odometry_, encode(odometry_message(pose, frames_)));
  std::vector<TransformMessage> transforms;
  if (odom_base_rate_.is_due(pose.stamp)) transforms.push_back(odom_base_transform(pose, frames_));
  if (pose.T_map_body && map_odom_rate_.is_due(pose.stamp)) {
    transforms.push_back(map_odom_transform(pose, frames_));
  }
  if (!transforms.empty()) write(tf_, encode(transforms));
}

void Ros2Output::write(Ros2Writer& writer, Bytes message) {
  if (!writer.write(std::move(message))) ++unpublished_;
}

bool Ros2Output::has_readers() const {
  return odometry_.matched_readers() > 0 && map_pose_.matched_readers() > 0 &&
         tf_.matched_readers() > 0;
}

std::map<std::string, std::uint64_t> Ros2Output::faults() const {
  if (unpublished_ == 0) return {};
  return {{"unpublished_ros2_messages", unpublished_}};
}

}  // namespace fleetloc
