#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shared/link/channel.hpp"
#include "shared/transport/participant.hpp"

namespace fleetloc {

/// A topic that somebody in the domain writes or reads, this observer not counted.
struct ObservedTopic {
  std::string name;
  std::string type;
  std::size_t writers = 0;
  std::size_t readers = 0;
};

struct ObservedSample {
  std::string topic;
  Bytes payload;
};

/// Sees which topics there are, and joins those of fleetloc as one more reader. That is not free
/// for the writers: best effort goes to each reader in a datagram of its own. One thread at a time.
class TopicObserver {
 public:
  /// @param profile  of a participant: "robot" or "cloud". A discovery server, which tells others
  ///                 only of what concerns them, tells an observer everything
  /// @param local    the same, for fleetloc/pose, which does not leave its computer: "local"
  TopicObserver(std::uint32_t domain,
                const std::string& profile,
                const std::string& local,
                const std::optional<FleetKeys>& keys = std::nullopt);
  ~TopicObserver();
  TopicObserver(const TopicObserver&) = delete;
  TopicObserver& operator=(const TopicObserver&) = delete;

  /// By name. Grows for some seconds, until discovery has ended.
  [[nodiscard]] std::vector<ObservedTopic> topics() const;

  /// Samples of this topic from now on; the last one of each robot or localizer as well, where the
  /// topic is reliable. False for a topic that is not fleetloc's.
  bool read(const std::string& topic);
  [[nodiscard]] bool reads(const std::string& topic) const { return readers_.contains(topic); }

  /// What has arrived since the last call.
  std::vector<ObservedSample> take();

 private:
  class Discovery;

  std::unique_ptr<Discovery> discovery_;  // outlives the participants
  Participant participant_, local_;
  std::map<std::string, EntityPtr<eprosima::fastdds::dds::DataReader>> readers_;
};

}  // namespace fleetloc
