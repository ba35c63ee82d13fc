#include "shared/transport/dds_connection.hpp"

#include <algorithm>
#include <span>

#include <fastdds/dds/core/status/PublicationMatchedStatus.hpp>
#include <fastdds/dds/core/status/SubscriptionMatchedStatus.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "shared/core/ids.hpp"

namespace fleetloc {

namespace dds = eprosima::fastdds::dds;

namespace {

std::vector<dds::DataReader*> readers_of(const auto& subscriptions) {
  std::vector<dds::DataReader*> readers;
  readers.reserve(subscriptions.size());
  for (const auto& subscription : subscriptions) readers.push_back(subscription.reader.get());
  return readers;
}

}  // namespace

DdsConnection::DdsConnection(const DdsChannelConfig& end,
                             const std::shared_ptr<WireLink>& wire,
                             const ParticipantOptions& options,
                             Deliver deliver)
    : keys_(options.keys),
      wire_(wire),
      participant_(end.domain, end.participant_profile, wire, options),
      subscriptions_(subscribe(end)),
      versions_(end.role == ChannelRole::kCloud ? participant_.create_writer(versions_topic_spec())
                                                : nullptr),
      deliver_(std::move(deliver)),
      thread_(readers_of(subscriptions_),
              [this](dds::DataReader& reader) { return take(reader); }) {}

dds::DataWriter& DdsConnection::writer(const Destination& destination) {
  const auto existing = writers_.find(destination);
  if (existing != writers_.end()) return *existing->second;
  const auto& [topic, receiver] = destination;
  auto created = participant_.create_writer(topic_spec(topic, receiver));
  return *writers_.emplace(destination, std::move(created)).first->second;
}

void DdsConnection::release(const std::string& receiver) {
  std::erase_if(writers_, [&](const auto& item) { return item.first.second == receiver; });
}

std::set<std::string> DdsConnection::present() const {
  std::set<std::string> present;
  for (const auto& [destination, writer] : writers_) {
    dds::PublicationMatchedStatus matched;
    writer->get_publication_matched_status(matched);
    if (matched.current_count > 0) present.insert(destination.second);
  }
  return present;
}

bool DdsConnection::is_alone() const {
  const auto status =
      std::ranges::find(subscriptions_, Topic::kLocalizerStatus, &Subscription::topic);
  if (status == subscriptions_.end()) return false;
  dds::SubscriptionMatchedStatus matched;
  status->reader->get_subscription_matched_status(matched);
  return matched.current_count == 0;
}

void DdsConnection::seek_other_versions() {
  if (!other_versions_) other_versions_ = participant_.create_reader(versions_topic_spec());
}

std::vector<DdsConnection::Subscription> DdsConnection::subscribe(const DdsChannelConfig& end) {
  if (!is_valid_id(end.name)) throw TransportError("not a valid name: '" + end.name + "'");
  std::vector<Subscription> subscriptions;
  const auto subscribe_to = [&](Topic topic, const std::string& receiver) {
    auto reader = participant_.create_reader(topic_spec(topic, receiver));
    subscriptions.push_back({.topic = topic, .reader = std::move(reader)});
  };
  if (end.role == ChannelRole::kRobot) {
    subscribe_to(Topic::kLocalization, end.name);
    subscribe_to(Topic::kLocalizerStatus, "");
  } else {
    subscribe_to(Topic::kSession, end.name);
    subscribe_to(Topic::kSubmap, end.name);
    subscribe_to(Topic::kCompactSubmap, end.name);
    subscribe_to(Topic::kRobotStatus, end.name);
  }
  return subscriptions;
}

bool DdsConnection::take(dds::DataReader& reader) {
  const auto subscription = std::ranges::find_if(
      subscriptions_, [&](const Subscription& one) { return one.reader.get() == &reader; });
  Message message{.topic = subscription->topic, .payload = {}};
  dds::SampleInfo info;
  if (reader.take_next_sample(&message.payload, &info) != ReturnCode_t::RETCODE_OK) return false;
  if (!info.valid_data) return true;
  const auto key = key_of(message.payload);
  if (!key) {
    deliver_(unexpected(key.error()));
  } else if (!is_of_its_writer(message.topic, *key, info.publication_handle)) {
    deliver_(unexpected(KeyDefect::kForeignWriter));
  } else {
    message.sender = sender_of(info.publication_handle);
    deliver_(std::move(message));
  }
  return true;
}

// The key of an answer is its receiver's; by their permissions only localizers write some.
bool DdsConnection::is_of_its_writer(Topic topic,
                                     std::string_view key,
                                     const dds::InstanceHandle_t& writer) const {
  if (!keys_ || topic == Topic::kLocalization) return true;
  const FleetRole role =
      topic == Topic::kLocalizerStatus ? FleetRole::kLocalizer : FleetRole::kRobot;
  const auto guid = iHandle2GUID(writer);
  const auto expected_begin = keys_->guid_begin(role, std::string(key));
  return std::ranges::equal(expected_begin,
                            std::span(guid.guidPrefix.value).first(expected_begin.size()));
}

// A member keeps the begin of its GUIDs, however often its program starts and wherever: who shares
// its computer is another one.
MessageSender DdsConnection::sender_of(const dds::InstanceHandle_t& writer) const {
  const auto guid = iHandle2GUID(writer);
  GuidPrefix prefix{};
  std::ranges::copy(guid.guidPrefix.value, prefix.begin());
  MessageSender sender{.participant = prefix};
  if (keys_) {
    std::ranges::fill(std::span(sender.participant).subspan(FleetKeys::GuidBegin{}.size()), 0);
  } else {
    sender.address = wire_->senders.address_of(prefix).value_or(0);
  }
  return sender;
}

}  // namespace fleetloc
