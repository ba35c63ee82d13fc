#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "robot/live/image_pairing.hpp"
#include "robot/live/measurement_queue.hpp"
#include "robot/live/stamp_gate.hpp"
#include "robot/live/topic_watch.hpp"
#include "robot/sensors/sensor_source.hpp"
#include "shared/core/arrival_time.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// Live images and IMU samples as they arrive in, measurements for a RobotPipeline out. IMU samples
/// go on at once, frames as soon as they are complete and an IMU sample has reached their stamp.
/// Stamps of frames and of IMU samples increase until a ClockStep. The robot's clock is the IMU's:
/// when it is set, a ClockStep goes before its first sample, and what waits is dropped; a camera
/// whose clock is another one is said, and its frames are dropped until it is right again.
///
/// Owns no thread and reads no clock; all memory is bounded, whatever arrives.
class SensorAssembler {
 public:
  struct Config {
    Duration pairing = std::chrono::milliseconds(4);    ///< largest difference in a pair
    Duration max_wait = std::chrono::milliseconds(50);  ///< for the partner, and then for the IMU
    /// Of a topic, before it is said: of the IMU, the shortest gap that resets the odometry.
    Duration silence = std::chrono::milliseconds(500);
    /// What a frame may be from the newest IMU sample: the odometry holds it that long, no longer.
    Duration max_ahead_of_imu = std::chrono::milliseconds(500);
    Duration max_behind_imu = std::chrono::seconds(1);
    Duration camera_time_shift{};  ///< is added to the stamps of images
    /// That wait to be taken: 0.5 s at 20 Hz, which is what the odometry's initialization takes.
    std::size_t max_frames = 10;
    std::size_t max_imu = 4000;  ///< samples that wait to be taken
  };
  /// As they are called in sentences.
  struct Topics {
    std::string left;
    std::string right;
    std::string imu;
  };

  SensorAssembler(const Config& config, const Topics& topics, const StereoCalibration& cameras);

  /// @param gray  8 bit, is kept and not copied; another type or size than the calibrated one
  ///     counts as missing
  /// @param decoding_cpu  what decoding it took; only for reports
  void add_left(Timestamp stamp, cv::Mat gray, ArrivalTime arrival, Duration decoding_cpu = {});
  void add_right(Timestamp stamp, cv::Mat gray, ArrivalTime arrival, Duration decoding_cpu = {});
  void add_imu(const ImuSample& sample, ArrivalTime arrival);

  /// To be called a hundred times a second while nothing arrives: what waits goes on, and silence
  /// is noticed.
  void poll(ArrivalTime now);

  /// The next measurement, if there is one.
  std::optional<SensorMeasurement> take() { return queue_.take(); }

  /// Sentences for the log since the last call, at most 64.
  std::vector<std::string> take_events();

  /// Counts by name, from the start:
  /// - "imu_..." and "images_...", by StampRefusal; "imu_impossible"
  /// - "wrong_images": not of the calibrated size, or not 8 bit gray
  /// - "unpaired_images": frames with one empty image
  /// - "images_late": a frame of their time had gone out
  /// - "frames_ahead_of_imu", "frames_behind_imu": dropped, see Config
  /// - "frames_at_clock_step": dropped because a clock was set
  /// - "clock_steps": of the IMU; "camera_clock_steps"
  /// - "dropped_backlog", "dropped_imu_backlog": nobody took them in time
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const;

  /// Images, frames and samples that it holds.
  [[nodiscard]] std::size_t held() const;
  /// Topics on which nothing comes at present.
  [[nodiscard]] std::vector<std::string> silent_topics() const;

 private:
  struct Camera {
    TopicWatch watch;
    StampGate gate;
    cv::Size size;                 // calibrated
    std::optional<cv::Size> said;  // another one that has been said
  };
  struct HeldFrame {
    StereoFrame frame;
    ArrivalTime complete;
  };

  void add_image(Side side, LiveImage image);
  bool accept(Camera& camera, LiveImage& image);
  void check_image(Camera& camera, cv::Mat& gray);
  bool accept(const ImuSample& sample, ArrivalTime arrival);
  void imu_clock_stepped(const AcceptedStamp& accepted, Timestamp stamp);
  void drop_waiting_frames();
  void advance(ArrivalTime now);
  bool release(const HeldFrame& held, ArrivalTime now);
  void give(StereoFrame frame);
  void count(std::string_view name, std::uint64_t number = 1);
  void say(std::string event);
  void complain(std::string_view kind, ArrivalTime now, const std::string& event);
  Camera& camera(Side side) { return cameras_[static_cast<std::size_t>(side)]; }

  Config config_;
  std::array<Camera, 2> cameras_;
  TopicWatch imu_watch_;
  StampGate imu_gate_;
  Complaints complaints_;
  ImagePairing pairing_;
  std::deque<HeldFrame> held_;  // until the IMU has reached them
  std::optional<Timestamp> newest_imu_;
  std::optional<Timestamp> newest_frame_;  // that was given out
  MeasurementQueue queue_;
  std::deque<std::string> events_;
  std::map<std::string, std::uint64_t, std::less<>> counts_;
};

}  // namespace fleetloc
