#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/core/time.hpp"

namespace fleetloc {

/// The topics of the system, idl/ has their types.
enum class Topic {
  kSession,
  kSubmap,  ///< in the full encoding
  kCompactSubmap,
  kLocalization,
  kRobotStatus,
  kLocalizerStatus
};

/// A serialized sample: CDR with its four bytes of encapsulation, as DDS carries it.
using Bytes = std::vector<std::uint8_t>;

struct Message {
  Topic topic{};
  Bytes payload;
};

/// Traffic of a channel since it was created.
struct ChannelStatistics {
  std::uint64_t sent_messages = 0;
  std::uint64_t sent_payload_bytes = 0;
  std::uint64_t sent_wire_bytes = 0;  ///< with the headers of RTPS, UDP and IP and all meta traffic
  std::uint64_t received_messages = 0;
  std::uint64_t received_payload_bytes = 0;
  std::uint64_t received_wire_bytes = 0;
};

/// One end of the network: of one robot, or of one localizer. The protocol above it must tolerate
/// loss, delay, reordering and duplication of messages. Time is passed in: an in-memory channel
/// lives in it, a real network ignores it.
class Channel {
 public:
  Channel() = default;
  virtual ~Channel() = default;
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  /// @param partition  the receiver: the name of a localizer or the id of a robot; empty for the
  ///                   topics that everyone receives (session, localizer status)
  virtual void send(const std::string& partition, Message message, Timestamp now) = 0;

  /// What has arrived until `now`, in order of arrival; each message is returned once.
  [[nodiscard]] virtual std::vector<Message> receive(Timestamp now) = 0;

  [[nodiscard]] virtual ChannelStatistics statistics() const = 0;

  /// Frees the resources for sending to this partition, until something is sent to it again.
  virtual void release(const std::string& /*partition*/) {}
};

}  // namespace fleetloc
