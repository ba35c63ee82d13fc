#include "robot/node/live_sensors.hpp"

#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "robot/node/ros2_poses.hpp"
#include "robot/node/sensor_topics.hpp"
#include "shared/core/boot_time.hpp"
#include "shared/core/cpu_time.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/ros2/image_codec.hpp"
#include "shared/ros2/imu_codec.hpp"
#include "shared/ros2/pose_codec.hpp"
#include "shared/transport/ros2/receive_buffers.hpp"

namespace fleetloc {
namespace {

constexpr std::chrono::milliseconds kPollInterval(10);  // as SensorAssembler::poll() asks for

// What may wait for the thread that decodes: half a second of images, two of an IMU at 1 kHz.
constexpr std::size_t kMaxImages = 10;
constexpr std::size_t kMaxImu = 2000;
constexpr std::size_t kMaxGivenPoses = 5;

// Numbers of subscriptions().
constexpr std::size_t kLeft = 0;
constexpr std::size_t kRight = 1;
constexpr std::size_t kImu = 2;
constexpr std::size_t kInitialPose = 3;

std::vector<Ros2Subscription> subscriptions(const SensorsConfig& config) {
  return {{image_topic(config.left), kMaxImages},
          {image_topic(config.right), kMaxImages},
          {imu_topic(config.imu), kMaxImu},
          {initial_pose_topic(config.initial_pose), kMaxGivenPoses}};
}

SensorAssembler::Config assembler_config(const SensorsConfig& config, const SensorRig& rig) {
  SensorAssembler::Config assembler = config.assembler;
  assembler.camera_time_shift = rig.camera_time_shift;
  return assembler;
}

SensorAssembler::Topics names(const SensorsConfig& config) {
  return {.left = config.left.topic.name, .right = config.right.topic.name, .imu = config.imu.name};
}

std::string place_text(const Pose& T_map_base) {
  const Eigen::Matrix3d R = T_map_base.R.toRotationMatrix();
  const double yaw_deg = std::atan2(R(1, 0), R(0, 0)) / kRadPerDeg;
  return fmt::format("({:.2f}, {:.2f}, {:.2f}) m, heading {:.0f} degrees",
                     T_map_base.p.x(),
                     T_map_base.p.y(),
                     T_map_base.p.z(),
                     yaw_deg);
}

}  // namespace

LiveSensors::LiveSensors(const SensorsConfig& config,
                         const SensorRig& rig,
                         Ros2Participant& participant,
                         Say say,
                         std::function<void()> waiting)
    : config_(config),
      say_(std::move(say)),
      waiting_(std::move(waiting)),
      participant_(participant),
      topics_(participant, subscriptions(config)),
      assembler_(assembler_config(config, rig), names(config), rig.cameras),
      thread_([this](const std::stop_token& stop) { listen(stop); }) {}

std::optional<SensorMeasurement> LiveSensors::next(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  std::optional<SensorMeasurement> measurement;
  given_.wait(lock, stop, [&] {
    if (waiting_) waiting_();
    measurement = take();
    return measurement || error_;
  });
  if (stop.stop_requested()) return std::nullopt;
  if (!measurement) std::rethrow_exception(error_);
  return measurement;
}

std::optional<SensorMeasurement> LiveSensors::take() {
  if (given_pose_) return *std::exchange(given_pose_, std::nullopt);
  return assembler_.take();
}

std::map<std::string, std::uint64_t> LiveSensors::close() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  return faults();
}

void LiveSensors::listen(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested()) {
      const auto sample = topics_.take(stop, kPollInterval);
      if (sample) {
        add(*sample);
      } else {
        poll(boot_time());
      }
      check_datagrams(boot_time());
      for (const std::string& event : take_events()) say_(event);
      given_.notify_one();
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    error_ = std::current_exception();
    given_.notify_one();
  }
}

void LiveSensors::add(const Ros2Sample& sample) {
  if (sample.topic == kImu) return add_imu(sample);
  if (sample.topic == kInitialPose) return add_given_pose(sample);
  add_image(sample.topic == kLeft ? Side::kLeft : Side::kRight, sample);
}

void LiveSensors::add_image(Side side, const Ros2Sample& sample) {
  const ImageTopic& its = side == Side::kLeft ? config_.left : config_.right;
  const bool is_raw = its.transport == ImageTransport::kRaw;
  const Duration begin = thread_cpu_time();
  auto image = is_raw ? decode_image(sample.payload) : decode_compressed_image(sample.payload);
  const Duration cpu = thread_cpu_time() - begin;
  const std::lock_guard lock(mutex_);
  if (!image) return refuse(its.topic.name, "images_", image.error(), sample.arrival);
  const Timestamp stamp = image->header.stamp;
  if (side == Side::kLeft) {
    assembler_.add_left(stamp, std::move(image->gray), sample.arrival, cpu);
  } else {
    assembler_.add_right(stamp, std::move(image->gray), sample.arrival, cpu);
  }
}

void LiveSensors::add_imu(const Ros2Sample& sample) {
  const auto message = decode_imu(sample.payload);
  const std::lock_guard lock(mutex_);
  if (!message) return refuse(config_.imu.name, "imu_", message.error(), sample.arrival);
  assembler_.add_imu(message->sample, sample.arrival);
}

void LiveSensors::add_given_pose(const Ros2Sample& sample) {
  const std::string& topic = config_.initial_pose.name;
  const auto message = decode_pose(sample.payload);
  const std::lock_guard lock(mutex_);
  if (!message) return refuse(topic, "initial_pose_", message.error(), sample.arrival);
  const auto given = given_pose(*message, config_.frames);
  if (!given) {
    ++refused_["initial_pose_in_another_frame"];
    if (!complaints_.is_new(topic, sample.arrival)) return;
    sentences_.push_back(topic + ": only poses in '" + config_.frames.map + "' are used");
    return;
  }
  given_pose_ = given;
  sentences_.push_back(topic + ": the robot is at " + place_text(message->T_a_b));
}

void LiveSensors::refuse(const std::string& topic,
                         const std::string& kind,
                         Ros2Refusal reason,
                         ArrivalTime arrival) {
  const std::string reason_name(name(reason));
  ++refused_[kind + reason_name];
  assembler_.poll(arrival);
  if (!complaints_.is_new(topic + reason_name, arrival)) return;
  sentences_.push_back(topic + ": messages are not used: " + reason_name);
}

// Only while nothing waits: messages tell the time by their arrival, and what the clock says now
// would let the assembler give up on those behind them.
void LiveSensors::poll(ArrivalTime now) {
  const std::lock_guard lock(mutex_);
  assembler_.poll(now);
}

void LiveSensors::check_datagrams(ArrivalTime now) {
  constexpr std::chrono::seconds kInterval(1);
  if (now < next_check_) return;
  next_check_ = now + kInterval;
  check_buffers(now);
  check_form(now);
}

void LiveSensors::check_buffers(ArrivalTime now) {
  const BufferLoss loss = buffer_loss(static_cast<std::uint32_t>(config_.domain));
  const std::lock_guard lock(mutex_);
  if (loss.datagrams <= lost_datagrams_) return;
  lost_datagrams_ = loss.datagrams;
  if (!complaints_.is_new("receive buffers", now)) return;
  sentences_.push_back(buffer_advice(loss, rmem_max_bytes()));
}

void LiveSensors::check_form(ArrivalTime now) {
  std::uint64_t datagrams = 0;
  std::string defects;
  for (const auto& [defect, count] : participant_.malformed()) {
    datagrams += count;
    defects += fmt::format("{}{} {}", defects.empty() ? "" : ", ", defect, count);
  }
  const std::lock_guard lock(mutex_);
  if (datagrams <= malformed_datagrams_) return;
  malformed_datagrams_ = datagrams;
  if (!complaints_.is_new("malformed datagrams", now)) return;
  sentences_.push_back(fmt::format(
      "domain {} of ROS 2: datagrams that are not RTPS were dropped: {}", config_.domain, defects));
}

std::vector<std::string> LiveSensors::take_events() {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> events = std::exchange(sentences_, {});
  for (std::string& event : assembler_.take_events()) events.push_back(std::move(event));
  return events;
}

std::map<std::string, std::uint64_t> LiveSensors::faults() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::uint64_t> faults = assembler_.faults();
  for (const auto& [kind, count] : refused_) faults[kind] += count;
  faults["dropped_images"] += topics_.dropped(kLeft) + topics_.dropped(kRight);
  faults["dropped_imu_backlog"] += topics_.dropped(kImu);
  faults["datagrams_without_room"] += lost_datagrams_;
  faults["malformed_datagrams"] += malformed_datagrams_;
  return faults;
}

std::vector<std::string> LiveSensors::silent_topics() const {
  const std::lock_guard lock(mutex_);
  return assembler_.silent_topics();
}

}  // namespace fleetloc
