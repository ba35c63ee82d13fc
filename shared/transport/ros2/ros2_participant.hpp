#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "shared/link/channel.hpp"
#include "shared/transport/participant.hpp"
#include "shared/transport/reader_thread.hpp"
#include "shared/transport/ros2/arrival_queue.hpp"

namespace fleetloc {

/// The QoS profiles of ROS 2: `ros2_...` in qos_profiles/ros2.xml.
enum class Ros2Qos {
  kSensorData,  ///< best effort: a reader of this kind matches every writer
  kDefault,     ///< reliable: so must be the other side
  kLatched,     ///< reliable, and the last sample is kept for those who come later
};

struct Ros2Topic {
  std::string name;  ///< in DDS, e.g. "rt/imu"
  std::string type;  ///< in DDS, e.g. "sensor_msgs::msg::dds_::Imu_"
  Ros2Qos qos = Ros2Qos::kSensorData;
};

struct Ros2Subscription {
  Ros2Topic topic;
  std::size_t capacity = 1;  ///< samples that may wait; then the oldest is dropped
};

/// Writes one topic. Must not outlive its participant. One thread at a time.
class Ros2Writer {
 public:
  explicit Ros2Writer(EntityPtr<eprosima::fastdds::dds::DataWriter> writer)
      : writer_(std::move(writer)) {}

  /// @param message  CDR with its encapsulation. False if the QoS limits refused it.
  bool write(Bytes message) { return writer_->write(&message); }

  [[nodiscard]] int matched_readers() const;

  /// Until reliable readers have all that was written. False if that takes longer than `max_wait`.
  bool wait_for_acknowledgments(std::chrono::milliseconds max_wait);

 private:
  EntityPtr<eprosima::fastdds::dds::DataWriter> writer_;
};

/// This process among those of ROS 2, over DDS and without ROS: plain CDR without keys, in a domain
/// and on network interfaces of their own (the participant `ros2` of the profiles: loopback), so
/// that images never reach the fleet's network. load_ros2_profiles() first. One thread at a time.
class Ros2Participant {
 public:
  /// Throws TransportError.
  /// @param domain  0..100, ROS_DOMAIN_ID
  explicit Ros2Participant(std::uint32_t domain);

  /// Both throw TransportError. The participant outlives what it creates.
  Ros2Writer create_writer(const Ros2Topic& topic);
  EntityPtr<eprosima::fastdds::dds::DataReader> create_reader(const Ros2Topic& topic);

  /// Datagrams that were dropped because they are not well-formed RTPS, by their defect. Any
  /// thread.
  [[nodiscard]] std::map<std::string, std::uint64_t> malformed() const {
    return participant_.malformed();
  }

 private:
  Participant participant_;
};

/// Reads some topics: a thread of its own takes what arrives.
class Ros2Reader {
 public:
  /// Throws TransportError.
  /// @param participant  outlives the reader
  /// @param subscriptions  their numbers are those of the samples
  Ros2Reader(Ros2Participant& participant, const std::vector<Ros2Subscription>& subscriptions);

  /// The next sample in the order of arrival; waits for it, at most `max_wait`. Nothing when a stop
  /// is requested. Any thread.
  std::optional<Ros2Sample> take(const std::stop_token& stop, std::chrono::milliseconds max_wait) {
    return arrivals_.pop(stop, max_wait);
  }

  /// Samples of a subscription that nobody took in time. Any thread.
  [[nodiscard]] std::uint64_t dropped(std::size_t subscription) const {
    return arrivals_.dropped(subscription);
  }
  [[nodiscard]] int matched_writers(std::size_t subscription) const;

 private:
  bool take_from(eprosima::fastdds::dds::DataReader& reader);

  ArrivalQueue arrivals_;
  std::vector<EntityPtr<eprosima::fastdds::dds::DataReader>> readers_;
  ReaderThread thread_;  // last, so that it ends before what it uses
};

}  // namespace fleetloc
