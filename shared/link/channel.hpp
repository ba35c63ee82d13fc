#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/link/message_sender.hpp"

namespace fleetloc {

/// The topics of the system, idl/ has their types. Each robot and each localizer has its own, but
/// for kLocalizerStatus, which is one for all.
enum class Topic {
  kSession,
  kSubmap,  ///< in the full encoding
  kCompactSubmap,
  kLocalization,
  kRobotStatus,
  kLocalizerStatus
};

/// Whether the latest message of a sender to a receiver is repeated until it arrives, also at one
/// that comes later. The others are best effort.
constexpr bool is_reliable(Topic topic) {
  return topic == Topic::kSession || topic == Topic::kLocalizerStatus;
}

/// A serialized sample: CDR with its four bytes of encapsulation, as DDS carries it.
using Bytes = std::vector<std::uint8_t>;

struct Message {
  Topic topic{};
  Bytes payload;
  MessageSender sender{};  ///< of one that was received
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
  ///                   topic that all robots receive (localizer status)
  virtual void send(const std::string& partition, Message message, Timestamp now) = 0;

  /// What has arrived until `now`, in order of arrival; each message is returned once.
  [[nodiscard]] virtual std::vector<Message> receive(Timestamp now) = 0;

  [[nodiscard]] virtual ChannelStatistics statistics() const = 0;

  /// Makes ready for sending to this receiver, which over DDS takes some exchanges of discovery: so
  /// that the first message does not wait for them.
  virtual void prepare(const std::string& /*partition*/) {}

  /// Frees the resources for sending to this receiver, until it is prepared or sent to again. What
  /// has not arrived by then is not repeated any more.
  virtual void release(const std::string& /*partition*/) {}
};

}  // namespace fleetloc
