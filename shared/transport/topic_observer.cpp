#include "shared/transport/topic_observer.hpp"

#include <algorithm>
#include <chrono>
#include <mutex>
#include <utility>

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>

#include "shared/transport/workarounds/peer_lookup.hpp"

namespace fleetloc {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

constexpr std::chrono::seconds kLookup{2};  // of peers' names

ParticipantOptions options_for(const std::string& profile,
                               dds::DomainParticipantListener* listener,
                               const std::optional<FleetKeys>& keys = std::nullopt) {
  ParticipantOptions options;
  options.keys = keys;
  options.peers = PeerLookup(named_peers(profile)).find(kLookup);
  options.listener = listener;
  options.is_told_everything = true;
  return options;
}

}  // namespace

/// Called on threads of the library.
class TopicObserver::Discovery final : public dds::DomainParticipantListener {
 public:
  void on_publisher_discovery(dds::DomainParticipant* /*own*/,
                              rtps::WriterDiscoveryInfo&& info) override {
    note(info.info, info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER, writers_);
  }
  void on_subscriber_discovery(dds::DomainParticipant* /*own*/,
                               rtps::ReaderDiscoveryInfo&& info) override {
    note(info.info, info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER, readers_);
  }

  void ignore(const rtps::GuidPrefix_t& participant) {
    const std::lock_guard lock(mutex_);
    own_.push_back(participant);
  }

  [[nodiscard]] std::vector<ObservedTopic> topics() const {
    const std::lock_guard lock(mutex_);
    std::map<std::string, ObservedTopic> topics;
    const auto count = [&](const Endpoints& endpoints, std::size_t ObservedTopic::*counter) {
      for (const auto& [guid, endpoint] : endpoints) {
        if (std::ranges::find(own_, guid.guidPrefix) != own_.end()) continue;
        ObservedTopic& topic = topics[endpoint.first];
        topic.name = endpoint.first;
        topic.type = endpoint.second;
        ++(topic.*counter);
      }
    };
    count(writers_, &ObservedTopic::writers);
    count(readers_, &ObservedTopic::readers);
    std::vector<ObservedTopic> sorted;
    for (auto& [name, topic] : topics) sorted.push_back(std::move(topic));
    return sorted;
  }

 private:
  using Endpoints = std::map<rtps::GUID_t, std::pair<std::string, std::string>>;  // topic, type

  void note(const auto& endpoint, bool is_removed, Endpoints& endpoints) {
    const std::lock_guard lock(mutex_);
    if (is_removed) {
      endpoints.erase(endpoint.guid());
    } else {
      endpoints[endpoint.guid()] = {endpoint.topicName().to_string(),
                                    endpoint.typeName().to_string()};
    }
  }

  mutable std::mutex mutex_;
  Endpoints writers_, readers_;
  std::vector<rtps::GuidPrefix_t> own_;
};

TopicObserver::TopicObserver(std::uint32_t domain,
                             const std::string& profile,
                             const std::string& local,
                             const std::optional<FleetKeys>& keys)
    : discovery_(std::make_unique<Discovery>()),
      participant_(domain, profile, nullptr, options_for(profile, discovery_.get(), keys)),
      local_(domain, local, nullptr, options_for(local, discovery_.get())) {
  discovery_->ignore(participant_.identity().prefix);
  discovery_->ignore(local_.identity().prefix);
}

TopicObserver::~TopicObserver() = default;

std::vector<ObservedTopic> TopicObserver::topics() const {
  return discovery_->topics();
}

bool TopicObserver::read(const std::string& topic) {
  if (reads(topic)) return true;
  const auto spec = topic_spec_of(topic);
  if (!spec) return false;
  Participant& participant = spec->partition.empty() ? participant_ : local_;
  readers_[topic] = participant.create_reader(*spec);
  return true;
}

std::vector<ObservedSample> TopicObserver::take() {
  std::vector<ObservedSample> samples;
  for (const auto& [topic, reader] : readers_) {
    Bytes bytes;
    dds::SampleInfo info;
    while (reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) samples.push_back({topic, std::exchange(bytes, {})});
    }
  }
  return samples;
}

}  // namespace fleetloc
