#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "shared/link/channel.hpp"
#include "shared/transport/dds_connection.hpp"
#include "shared/transport/receiver_presence.hpp"
#include "shared/transport/workarounds/network_addresses.hpp"
#include "shared/transport/workarounds/participant_recreation_policy.hpp"
#include "shared/transport/workarounds/peer_lookup.hpp"

namespace fleetloc {

/// Losses of a DdsChannel, and recreations of its participant.
struct ChannelDiagnostics {
  /// Samples without a key that can be read, by KeyDefect.
  std::map<std::string, std::uint64_t> undecodable;
  std::uint64_t overflowed = 0;   ///< messages dropped because the inbox was full
  std::uint64_t refused = 0;      ///< samples rejected by the QoS limits of the writer
  std::uint64_t unsent = 0;       ///< messages for which there was no participant
  std::uint64_t recreations = 0;  ///< participants created after the first
  /// Datagrams that are not RTPS, by RtpsDefect.
  std::map<std::string, std::uint64_t> malformed;
};

/// One end of the network over Fast DDS, with the QoS of the loaded profiles. Topics and receivers
/// are those of MemoryNetwork. Time is that of the network: `now` is ignored.
///
/// A writer is created when its receiver is prepared or first written to; until it is matched with
/// its reader, best effort samples are lost, and the protocol above has to repeat what matters. Any
/// thread may use any function.
///
/// When the addresses of this computer change, or the discovery server was restarted, the
/// participant is recreated behind this interface, on a thread of its own (see
/// ParticipantRecreationPolicy). Statistics continue, received messages stay, session and localizer
/// status are published again; what is sent meanwhile, for some tenths of a second, is lost.
class DdsChannel final : public Channel {
 public:
  using Config = DdsChannelConfig;

  /// Call load_qos_profiles() before. Throws TransportError.
  explicit DdsChannel(const Config& config);
  ~DdsChannel() override = default;
  DdsChannel(const DdsChannel&) = delete;
  DdsChannel& operator=(const DdsChannel&) = delete;

  /// Throws std::invalid_argument for a receiver that is not a valid id, but for the topic that all
  /// robots receive, whose receiver is empty.
  void send(const std::string& receiver, Message message, Timestamp now) override;
  [[nodiscard]] std::vector<Message> receive(Timestamp now) override;
  [[nodiscard]] ChannelStatistics statistics() const override;
  /// Creates the writers to a receiver.
  void prepare(const std::string& receiver) override;
  /// Deletes them. A localizer's writers to a robot that has not been there for a minute are
  /// deleted anyway.
  void release(const std::string& receiver) override;

  /// Waits for a message, at most for `patience` and until it is woken. False if there is none.
  bool wait_for_message(std::chrono::milliseconds patience);
  /// Ends the wait that another thread is in, or its next one.
  void wake();

  /// Number of readers matched with the writer to this receiver; creates the writer.
  int matched_readers(Topic topic, const std::string& receiver);
  [[nodiscard]] ChannelDiagnostics diagnostics() const;
  /// Changes of the network and the participant since the last call, each a line for a log.
  std::vector<std::string> take_events();

 private:
  std::unique_ptr<DdsConnection> connect(ParticipantOptions options);
  void deliver(expected<Message, KeyDefect> message);
  void watch(const std::stop_token& stop);
  void wait_and_look(ParticipantRecreationPolicy& policy,
                     const std::vector<std::string>& whitelist,
                     const std::stop_token& stop);
  [[nodiscard]] std::uint64_t signs_of_life() const;
  bool expects_somebody();
  void look_for_other_versions(std::chrono::steady_clock::time_point now);
  void delete_writers(const std::string& receiver);  // expects `sending_` to be locked
  void release_absent(std::chrono::steady_clock::time_point now);
  bool recreate(const std::string& reason, ParticipantOptions& options);
  void note(std::string event);

  Config config_;
  std::shared_ptr<WireLink> wire_;
  AddressWatch addresses_;
  PeerLookup lookup_;
  mutable std::mutex mutex_;  // guards what follows, up to the statistics; never held for long
  std::condition_variable arrived_;
  bool is_woken_ = false;
  std::deque<Message> inbox_;
  std::size_t inbox_bytes_ = 0;  // of its payloads
  std::vector<std::string> events_;
  ChannelDiagnostics diagnostics_;
  ChannelStatistics statistics_;  // without wire bytes
  std::mutex sending_;            // guards what follows; taken before mutex_
  std::set<Destination> destinations_;
  std::map<Destination, Message> last_reliable_;  // for late joiners after a recreation
  ReceiverPresence presence_;
  std::unique_ptr<DdsConnection> connection_;  // none while it is recreated
  std::optional<std::chrono::steady_clock::time_point> alone_since_;
  std::jthread watch_;  // last: it uses all others
};

}  // namespace fleetloc
