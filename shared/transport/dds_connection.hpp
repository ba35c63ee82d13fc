#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/link/channel.hpp"
#include "shared/transport/instance_key.hpp"
#include "shared/transport/participant.hpp"
#include "shared/transport/reader_thread.hpp"
#include "shared/transport/wire_transport.hpp"

namespace fleetloc {

/// Configuration of a DdsChannel: what stays the same when its connection is recreated.
struct DdsChannelConfig {
  std::uint32_t domain;  ///< 0..100
  std::string participant_profile;
  ChannelRole role;
  std::string name;                              ///< of the robot or the localizer
  std::optional<LinkConfig> link;                ///< emulated around this end, see EmulatedLink
  std::optional<FleetKeys> keys = std::nullopt;  ///< of this end, see ParticipantOptions
};

/// Topic and receiver of a writer, as in Channel::send.
using Destination = std::pair<Topic, std::string>;

/// The part of a DdsChannel that does not survive a change of the network: a participant with the
/// readers of its end and the writers used so far. One thread at a time.
class DdsConnection {
 public:
  /// Called on a thread of the connection with each sample, or what is wrong with it.
  using Deliver = std::function<void(expected<Message, KeyDefect>)>;

  /// Throws TransportError.
  DdsConnection(const DdsChannelConfig& end,
                const std::shared_ptr<WireLink>& wire,
                const ParticipantOptions& options,
                Deliver deliver);

  /// Created on first use.
  eprosima::fastdds::dds::DataWriter& writer(const Destination& destination);
  void release(const std::string& receiver);
  /// Receivers with a matched reader.
  [[nodiscard]] std::set<std::string> present() const;

  /// Of a robot: no localizer is matched.
  [[nodiscard]] bool is_alone() const;
  /// From now on localizers of every wire version are discovered.
  void seek_other_versions();

  [[nodiscard]] const Participant& participant() const { return participant_; }

 private:
  struct Subscription {
    Topic topic;
    EntityPtr<eprosima::fastdds::dds::DataReader> reader;
  };

  std::vector<Subscription> subscribe(const DdsChannelConfig& end);
  bool take(eprosima::fastdds::dds::DataReader& reader);
  /// Whether a robot or localizer speaks of itself; without keys nobody can tell.
  [[nodiscard]] bool is_of_its_writer(Topic topic,
                                      std::string_view key,
                                      const eprosima::fastdds::dds::InstanceHandle_t& writer) const;

  [[nodiscard]] MessageSender sender_of(
      const eprosima::fastdds::dds::InstanceHandle_t& writer) const;

  std::optional<FleetKeys> keys_;
  std::shared_ptr<WireLink> wire_;
  Participant participant_;
  std::map<Destination, EntityPtr<eprosima::fastdds::dds::DataWriter>> writers_;
  std::vector<Subscription> subscriptions_;
  EntityPtr<eprosima::fastdds::dds::DataWriter> versions_;        // of a localizer
  EntityPtr<eprosima::fastdds::dds::DataReader> other_versions_;  // of a robot that seeks them
  Deliver deliver_;
  ReaderThread thread_;  // last, so that it ends before what it uses
};

}  // namespace fleetloc
