#include "robot/node/calibration_topics.hpp"

#include <array>

#include "robot/live/topic_watch.hpp"
#include "robot/node/sensor_topics.hpp"
#include "shared/core/boot_time.hpp"

namespace fleetloc {
namespace {

using Say = std::function<void(const std::string&)>;

constexpr std::chrono::milliseconds kCameraInfoPollInterval(100);

/// CameraInfo of one camera.
class InfoTopic {
 public:
  InfoTopic(const RosTopic& topic, Duration silence) : watch_(topic.name, silence) {}

  void add(const Ros2Sample& sample, const Say& say) {
    if (auto event = watch_.arrived(sample.arrival)) say(*event);
    const auto message = decode_camera_info(sample.payload);
    if (!message) return complain(std::string(name(message.error())), sample.arrival, say);
    info_ = whole_image_info(*message);
    if (!info_) complain("binned_or_cut_out", sample.arrival, say);
  }
  void check(ArrivalTime now, const Say& say) {
    if (auto event = watch_.check(now)) say(*event);
  }
  [[nodiscard]] const std::optional<CameraInfo>& info() const { return info_; }

 private:
  void complain(const std::string& reason, ArrivalTime now, const Say& say) {
    if (!complaints_.is_new(reason, now)) return;
    say(watch_.topic() + ": messages are not used: " + reason);
  }

  TopicWatch watch_;
  Complaints complaints_;
  std::optional<CameraInfo> info_;
};

}  // namespace

std::optional<CameraInfo> whole_image_info(const CameraInfoMessage& message) {
  const CameraInfoMessage::Region& region = message.region;
  const bool is_whole =
      region.x_px == 0 && region.y_px == 0 &&
      (region.width_px == 0 || region.width_px == static_cast<std::uint32_t>(message.width_px)) &&
      (region.height_px == 0 || region.height_px == static_cast<std::uint32_t>(message.height_px));
  if (message.binning_x > 1 || message.binning_y > 1 || !is_whole) return std::nullopt;
  return CameraInfo{.width_px = static_cast<std::uint32_t>(message.width_px),
                    .height_px = static_cast<std::uint32_t>(message.height_px),
                    .distortion_model = message.distortion_model,
                    .D = message.coefficients,
                    .K = message.K,
                    .R = message.R,
                    .P = message.P};
}

std::optional<SensorRig> calibration_from_topics(const SensorsConfig& config,
                                                 Ros2Participant& participant,
                                                 const Say& say,
                                                 const std::stop_token& stop,
                                                 const std::function<void()>& waiting) {
  const auto& source = std::get<CameraInfoSource>(config.calibration);
  Ros2Reader reader(participant,
                    {{camera_info_topic(source.left), 1}, {camera_info_topic(source.right), 1}});
  std::array topics{InfoTopic(source.left, config.assembler.silence),
                    InfoTopic(source.right, config.assembler.silence)};
  Complaints complaints;
  while (!stop.stop_requested()) {
    if (waiting) waiting();
    const auto sample = reader.take(stop, kCameraInfoPollInterval);
    if (sample) topics.at(sample->topic).add(*sample, say);
    for (InfoTopic& topic : topics) topic.check(boot_time(), say);
    if (!sample || !topics[0].info() || !topics[1].info()) continue;
    const auto cameras =
        stereo_calibration(*topics[0].info(), *topics[1].info(), source.images, source.T_imu_cam0);
    if (cameras) return SensorRig{.cameras = *cameras, .imu_noise = source.imu_noise};
    const std::string reason(name(cameras.error()));
    if (complaints.is_new(reason, sample->arrival)) {
      say("CameraInfo of the pair is not used: " + reason);
    }
  }
  return std::nullopt;
}

}  // namespace fleetloc
