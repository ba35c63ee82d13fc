#include "deploy/play/sensor_publisher.hpp"

#include <utility>

#include "robot/node/sensor_topics.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/ros2/image_codec.hpp"
#include "shared/ros2/imu_codec.hpp"

namespace fleetloc {
namespace {

Ros2Topic raw_image_topic(const ImageTopic& topic) {
  if (topic.transport == ImageTransport::kCompressed) {
    throw ConfigError(topic.topic.name + ": only raw images are played, not compressed ones");
  }
  return image_topic(topic);
}

}  // namespace

SensorPublisher::SensorPublisher(const SensorsConfig& config)
    : participant_(static_cast<std::uint32_t>(config.domain)),
      left_(participant_.create_writer(raw_image_topic(config.left))),
      right_(participant_.create_writer(raw_image_topic(config.right))),
      imu_(participant_.create_writer(imu_topic(config.imu))) {}

void SensorPublisher::publish(const SensorMeasurement& measurement) {
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
    write(imu_, encode(ImuMessage{.frame = "imu0", .sample = *sample}), counts_.imu);
  } else if (const auto* frame = std::get_if<CameraFrame>(&measurement)) {
    if (const auto* images = std::get_if<StereoFrame>(frame)) publish(*images);
  }
}

void SensorPublisher::publish(const StereoFrame& frame) {
  const auto message = [&](const char* camera, const cv::Mat& gray) {
    return encode(ImageMessage{.header = {.stamp = frame.stamp, .frame = camera}, .gray = gray});
  };
  if (!frame.left.empty()) write(left_, message("cam0", frame.left), counts_.left);
  if (!frame.right.empty()) write(right_, message("cam1", frame.right), counts_.right);
}

void SensorPublisher::write(Ros2Writer& writer, Bytes message, std::uint64_t& count) {
  ++(writer.write(std::move(message)) ? count : counts_.refused);
}

bool SensorPublisher::has_readers() const {
  return left_.matched_readers() > 0 && right_.matched_readers() > 0 && imu_.matched_readers() > 0;
}

bool SensorPublisher::wait_for_acknowledgments(std::chrono::milliseconds max_wait) {
  bool all = true;
  for (Ros2Writer* writer : {&left_, &right_, &imu_}) {
    all = writer->wait_for_acknowledgments(max_wait) && all;
  }
  return all;
}

}  // namespace fleetloc
