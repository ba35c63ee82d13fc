#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/link/channel.hpp"
#include "shared/transport/participant.hpp"
#include "shared/transport/reader_thread.hpp"
#include "shared/transport/wire_transport.hpp"

namespace fleetloc {

/// What a DdsChannel did not hand over.
struct ChannelDiagnostics {
  std::uint64_t undecodable = 0;  ///< samples that are not what their type says
  std::uint64_t overflowed =
      0;                      ///< messages that nobody took for so long that newer ones did not fit
  std::uint64_t refused = 0;  ///< samples that the QoS limits did not let out
};

/// One end of the network over Fast DDS, with the QoS of the loaded profiles. Topics, partitions
/// and who hears what are those of MemoryNetwork. Time is that of the network: `now` is ignored.
///
/// A writer is created when its partition is first written to; until it has found its readers, best
/// effort samples are lost, and the protocol above has to repeat what matters. Any thread may use
/// any function.
class DdsChannel final : public Channel {
 public:
  struct Config {
    std::uint32_t domain;  ///< 0..100
    std::string participant_profile;
    ChannelRole role;
    std::string name;                ///< of the robot or the localizer: its partition
    std::optional<LinkConfig> link;  ///< emulated around this end, see WireLink
  };

  /// Needs load_qos_profiles() before. A TransportError says what is wrong.
  explicit DdsChannel(const Config& config);
  ~DdsChannel() override = default;
  DdsChannel(const DdsChannel&) = delete;
  DdsChannel& operator=(const DdsChannel&) = delete;

  /// Throws std::invalid_argument for a partition that is neither empty nor a valid id: `*` would
  /// reach everyone.
  void send(const std::string& partition, Message message, Timestamp now) override;
  [[nodiscard]] std::vector<Message> receive(Timestamp now) override;
  [[nodiscard]] ChannelStatistics statistics() const override;
  /// Disposes of the writers in a partition; the others leave their readers be.
  void release(const std::string& partition) override;

  /// Waits until receive() has something to give, at most for `patience`.
  bool wait_for_message(std::chrono::milliseconds patience);

  /// How many readers hear what is sent to this partition; creates the writer.
  int matched_readers(Topic topic, const std::string& partition);
  [[nodiscard]] ChannelDiagnostics diagnostics() const;

 private:
  using Writer = EntityPtr<eprosima::fastdds::dds::DataWriter>;
  struct Subscription {
    Topic topic;
    EntityPtr<eprosima::fastdds::dds::DataReader> reader;
  };

  eprosima::fastdds::dds::DataWriter& writer(Topic topic, const std::string& partition);
  std::vector<Subscription> subscribe(const Config& config);
  bool take(eprosima::fastdds::dds::DataReader& reader);
  void deliver(Message message);

  std::shared_ptr<WireLink> wire_;
  mutable std::mutex sending_;  // guards participant_ and writers_
  Participant participant_;
  std::map<std::pair<Topic, std::string>, Writer> writers_;
  std::vector<Subscription> subscriptions_;
  mutable std::mutex mutex_;  // guards what follows, but not the thread
  std::condition_variable arrived_;
  std::deque<Message> inbox_;
  ChannelStatistics statistics_;  // without wire bytes
  ChannelDiagnostics diagnostics_;
  ReaderThread thread_;  // last, so that it ends before what it uses
};

}  // namespace fleetloc
