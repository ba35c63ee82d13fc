#include "deploy/play/sensor_publisher.hpp"

#include <utility>

#include "robot/node/sensor_topics.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/ros2/image_codec.hpp"
#include "shared/ros2/imu_codec.hpp"

namespace fleetloc {
namespace {

constexpr int kJpegQuality = 95;  // the default of OpenCV, and so of image_transport

/// Nothing where the robot has its calibration from files.
const CameraInfoSource* info_source(const SensorsConfig& config) {
  const auto* source = std::get_if<CameraInfoSource>(&config.calibration);
  if (source != nullptr && source->images == ImageKind::kRectified) {
    throw ConfigError("calibration: camera_info: images: a recording is played raw, not rectified");
  }
  return source;
}

}  // namespace

SensorPublisher::SensorPublisher(const SensorsConfig& config, const StereoCalibration& calibration)
    : participant_(static_cast<std::uint32_t>(config.domain)),
      left_(camera_topics(config.left, "cam0")),
      right_(camera_topics(config.right, "cam1")),
      imu_(participant_.create_writer(imu_topic(config.imu))) {
  const CameraInfoSource* source = info_source(config);
  if (source == nullptr) return;
  const auto [left, right] = camera_info(calibration);
  left_.info = InfoTopic{participant_.create_writer(camera_info_topic(source->left)), left};
  right_.info = InfoTopic{participant_.create_writer(camera_info_topic(source->right)), right};
}

SensorPublisher::CameraTopics SensorPublisher::camera_topics(const ImageTopic& images,
                                                             std::string frame) {
  return {.images = participant_.create_writer(image_topic(images)),
          .transport = images.transport,
          .frame = std::move(frame),
          .info = std::nullopt};
}

void SensorPublisher::publish(const SensorMeasurement& measurement) {
  if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
    write(imu_, encode(ImuMessage{.frame = "imu0", .sample = *sample}), counts_.imu);
  } else if (const auto* frame = std::get_if<CameraFrame>(&measurement)) {
    const auto* images = std::get_if<StereoFrame>(frame);
    if (images == nullptr) return;
    publish(left_, images->stamp, images->left, counts_.left);
    publish(right_, images->stamp, images->right, counts_.right);
  }
}

void SensorPublisher::publish(CameraTopics& camera,
                              Timestamp stamp,
                              const cv::Mat& gray,
                              std::uint64_t& count) {
  if (gray.empty()) return;
  const ImageMessage image{.header = {.stamp = stamp, .frame = camera.frame}, .gray = gray};
  const bool is_raw = camera.transport == ImageTransport::kRaw;
  write(camera.images, is_raw ? encode(image) : encode_as_jpeg(image, kJpegQuality), count);
  publish_info(camera, stamp);
}

void SensorPublisher::publish_info(CameraTopics& camera, Timestamp stamp) {
  if (!camera.info) return;
  CameraInfoMessage& message = camera.info->message;
  message.header = {.stamp = stamp, .frame = camera.frame};
  write(camera.info->topic, encode(message), counts_.camera_info);
}

void SensorPublisher::publish_camera_info(Timestamp stamp) {
  publish_info(left_, stamp);
  publish_info(right_, stamp);
}

void SensorPublisher::write(Ros2Writer& writer, Bytes message, std::uint64_t& count) {
  ++(writer.write(std::move(message)) ? count : counts_.refused);
}

std::vector<Ros2Writer*> SensorPublisher::writers() {
  std::vector<Ros2Writer*> writers{&left_.images, &right_.images, &imu_};
  for (CameraTopics* camera : {&left_, &right_}) {
    if (camera->info) writers.push_back(&camera->info->topic);
  }
  return writers;
}

bool SensorPublisher::has_readers() const {
  return left_.images.matched_readers() > 0 && right_.images.matched_readers() > 0 &&
         imu_.matched_readers() > 0;
}

bool SensorPublisher::wait_for_acknowledgments(std::chrono::milliseconds max_wait) {
  bool all = true;
  for (Ros2Writer* writer : writers()) all = writer->wait_for_acknowledgments(max_wait) && all;
  return all;
}

}  // namespace fleetloc
