#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "robot/calibration/sensor_rig.hpp"
#include "robot/live/sensor_assembler.hpp"
#include "robot/live/sensors_config.hpp"
#include "robot/live/topic_watch.hpp"
#include "robot/sensors/sensor_source.hpp"
#include "shared/ros2/ros2_refusal.hpp"
#include "shared/transport/ros2/ros2_participant.hpp"

namespace fleetloc {

/// Measurements from topics of ROS 2. A thread of its own decodes what arrives and feeds the
/// SensorAssembler, so that silence is noticed also while nobody takes anything. A message that
/// cannot be used is counted and said, and never ends anything. What the kernel drops for want of
/// room is said with the setting to raise, and that somebody sends what is not RTPS. Has no end but
/// a stop.
class LiveSensors final : public SensorSource {
 public:
  /// Takes a sentence for the log, from the thread of the sensors.
  using Say = std::function<void(const std::string&)>;

  /// Throws TransportError.
  /// @param participant  outlives this
  /// @param waiting  called by next() again and again while it waits
  LiveSensors(const SensorsConfig& config,
              const SensorRig& rig,
              Ros2Participant& participant,
              Say say,
              std::function<void()> waiting = {});

  std::optional<SensorMeasurement> next(const std::stop_token& stop) override;
  [[nodiscard]] std::optional<std::size_t> frame_count() const override { return std::nullopt; }
  /// Stops the thread; returns faults().
  std::map<std::string, std::uint64_t> close() override;

  /// Those of the SensorAssembler; "images_", "imu_" and "initial_pose_" by Ros2Refusal;
  /// "initial_pose_in_another_frame"; "dropped_images" and
  /// "dropped_imu_backlog": not decoded in time; "datagrams_without_room": dropped by the kernel;
  /// "malformed_datagrams": of any topic of the participant. Any thread.
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const;

  /// Topics on which nothing usable comes at present. Any thread.
  [[nodiscard]] std::vector<std::string> silent_topics() const;

 private:
  void listen(const std::stop_token& stop);
  void poll(ArrivalTime now);
  void check_datagrams(ArrivalTime now);
  void check_buffers(ArrivalTime now);
  void check_form(ArrivalTime now);
  void add(const Ros2Sample& sample);
  void add_image(Side side, const Ros2Sample& sample);
  void add_imu(const Ros2Sample& sample);
  void add_given_pose(const Ros2Sample& sample);
  [[nodiscard]] std::optional<SensorMeasurement> take();
  void refuse(const std::string& topic,
              const std::string& kind,
              Ros2Refusal reason,
              ArrivalTime arrival);
  [[nodiscard]] std::vector<std::string> take_events();

  SensorsConfig config_;
  Say say_;
  std::function<void()> waiting_;
  const Ros2Participant& participant_;
  Ros2Reader topics_;

  mutable std::mutex mutex_;
  std::condition_variable_any given_;
  SensorAssembler assembler_;                     // guarded by mutex_, as are the next seven
  std::map<std::string, std::uint64_t> refused_;  // by kind and reason
  Complaints complaints_;
  std::vector<std::string> sentences_;   // to be said
  std::optional<GivenPose> given_pose_;  // the newest, not taken yet
  std::exception_ptr error_;
  std::uint64_t lost_datagrams_ = 0;
  std::uint64_t malformed_datagrams_ = 0;
  ArrivalTime next_check_;  // used by the thread only
  std::jthread thread_;     // last: uses the others
};

}  // namespace fleetloc
