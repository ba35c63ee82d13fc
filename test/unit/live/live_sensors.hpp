#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "robot/live/sensor_assembler.hpp"

namespace fleetloc {

inline constexpr Duration kEpoch = std::chrono::hours(24 * 365 * 50);
inline constexpr int kWidth = 6;
inline constexpr int kHeight = 4;

/// A stamp of the sensors' clock.
inline Timestamp at(Duration time) {
  return Timestamp{kEpoch + time};
}

inline ArrivalTime arriving(Duration time) {
  return ArrivalTime{std::chrono::hours(1) + time};
}

inline StereoCalibration small_cameras() {
  StereoCalibration cameras;
  for (Camera* camera : {&cameras.cam0, &cameras.cam1}) {
    camera->width_px = kWidth;
    camera->height_px = kHeight;
  }
  return cameras;
}

/// An image that knows its number.
inline cv::Mat image(std::uint32_t number = 0) {
  cv::Mat image(kHeight, kWidth, CV_8UC1, cv::Scalar(0));
  for (int i = 0; i < 4; ++i) {
    image.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(number >> (8 * i));
  }
  return image;
}

inline std::uint32_t number_of(const cv::Mat& image) {
  std::uint32_t number = 0;
  for (int i = 0; i < 4; ++i) number |= std::uint32_t{image.at<std::uint8_t>(0, i)} << (8 * i);
  return number;
}

inline ImuSample sample(Duration stamp) {
  return {.stamp = at(stamp), .specific_force = {0.0, 0.0, 9.81}};
}

/// A SensorAssembler, and what comes out of it as text: "imu 5", "frame 100", "left 100" (without
/// the right image), "clock -10000" (times in ms).
struct LiveSensors {
  explicit LiveSensors(const SensorAssembler::Config& config = {.max_frames = 4})
      : assembler(config, {"/left", "/right", "/imu"}, small_cameras()) {}

  void left(Duration stamp, Duration arrival) {
    assembler.add_left(at(stamp), image(), arriving(arrival));
  }
  void right(Duration stamp, Duration arrival) {
    assembler.add_right(at(stamp), image(), arriving(arrival));
  }
  void pair(Duration stamp, Duration arrival) {
    left(stamp, arrival);
    right(stamp, arrival);
  }
  void imu(Duration stamp, Duration arrival) {
    assembler.add_imu(sample(stamp), arriving(arrival));
  }

  /// IMU at 100 Hz and pairs at 10 Hz, both arriving at once, in [from, to); stamps by a clock that
  /// is `ahead` of the arrival's.
  void run(Duration from, Duration to, Duration ahead = {}) {
    using namespace std::chrono_literals;
    for (Duration t = from; t < to; t += 10ms) {
      imu(t + ahead, t);
      if (t % 100ms == Duration{}) pair(t + ahead, t);
    }
  }

  std::vector<std::string> taken() {
    std::vector<std::string> texts;
    while (const auto measurement = assembler.take()) texts.push_back(text_of(*measurement));
    return texts;
  }
  /// Frames and clock steps alone.
  std::vector<std::string> frames() {
    std::vector<std::string> texts = taken();
    std::erase_if(texts, [](const std::string& text) { return text.starts_with("imu"); });
    return texts;
  }

  [[nodiscard]] std::uint64_t fault(const std::string& name) const {
    const auto faults = assembler.faults();
    const auto found = faults.find(name);
    return found == faults.end() ? 0 : found->second;
  }

  SensorAssembler assembler;

 private:
  static std::string text_of(const SensorMeasurement& measurement) {
    const Duration stamp = stamp_of(measurement).time_since_epoch() - kEpoch;
    std::string kind = "imu ";
    if (std::holds_alternative<ClockStep>(measurement)) kind = "clock ";
    if (const auto* frame = std::get_if<CameraFrame>(&measurement)) {
      const auto& images = std::get<StereoFrame>(*frame);
      kind = images.right.empty() ? "left " : images.left.empty() ? "right " : "frame ";
    }
    return kind + std::to_string(std::chrono::floor<std::chrono::milliseconds>(stamp).count());
  }
};

}  // namespace fleetloc
