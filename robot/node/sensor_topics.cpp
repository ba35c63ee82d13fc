#include "robot/node/sensor_topics.hpp"

#include "shared/ros2/ros2_names.hpp"

namespace fleetloc {
namespace {

Ros2Qos ros2_qos(TopicQos qos) {
  return qos == TopicQos::kDefault ? Ros2Qos::kDefault : Ros2Qos::kSensorData;
}

}  // namespace

Ros2Topic image_topic(const ImageTopic& topic) {
  const bool compressed = topic.transport == ImageTransport::kCompressed;
  return {.name = dds_name(topic),
          .type = compressed ? ros2_type::kCompressedImage : ros2_type::kImage,
          .qos = ros2_qos(topic.topic.qos)};
}

Ros2Topic imu_topic(const RosTopic& topic) {
  return {.name = dds_name(topic), .type = ros2_type::kImu, .qos = ros2_qos(topic.qos)};
}

Ros2Topic camera_info_topic(const RosTopic& topic) {
  return {.name = dds_name(topic), .type = ros2_type::kCameraInfo, .qos = ros2_qos(topic.qos)};
}

Ros2Topic initial_pose_topic(const RosTopic& topic) {
  return {
      .name = dds_name(topic), .type = ros2_type::kPoseWithCovariance, .qos = ros2_qos(topic.qos)};
}

}  // namespace fleetloc
