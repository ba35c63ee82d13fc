#include "shared/transport/dds_channel.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include <fastdds/dds/core/status/PublicationMatchedStatus.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "shared/core/ids.hpp"
#include "shared/transport/bytes_type.hpp"

namespace fleetloc {

namespace dds = eprosima::fastdds::dds;

namespace {

constexpr std::size_t kInboxMessages = 4096;  // far more than one cycle of any program leaves

std::vector<dds::DataReader*> readers_of(const auto& subscriptions) {
  std::vector<dds::DataReader*> readers;
  readers.reserve(subscriptions.size());
  for (const auto& subscription : subscriptions) readers.push_back(subscription.reader.get());
  return readers;
}

}  // namespace

DdsChannel::DdsChannel(const Config& config)
    : wire_(std::make_shared<WireLink>(config.role, config.link)),
      participant_(config.domain, config.participant_profile, wire_),
      subscriptions_(subscribe(config)),
      thread_(readers_of(subscriptions_),
              [this](dds::DataReader& reader) { return take(reader); }) {}

void DdsChannel::send(const std::string& partition, Message message, Timestamp /*now*/) {
  const std::size_t size = message.payload.size();
  bool sent = false;
  {
    const std::lock_guard lock(sending_);
    sent = writer(message.topic, partition).write(&message.payload);
  }
  const std::lock_guard lock(mutex_);
  ++statistics_.sent_messages;
  statistics_.sent_payload_bytes += size;
  if (!sent) ++diagnostics_.refused;
}

std::vector<Message> DdsChannel::receive(Timestamp /*now*/) {
  const std::lock_guard lock(mutex_);
  std::vector<Message> messages(std::make_move_iterator(inbox_.begin()),
                                std::make_move_iterator(inbox_.end()));
  inbox_.clear();
  return messages;
}

ChannelStatistics DdsChannel::statistics() const {
  const WireTraffic traffic = wire_->traffic();
  const std::lock_guard lock(mutex_);
  ChannelStatistics statistics = statistics_;
  statistics.sent_wire_bytes = traffic.sent_bytes;
  statistics.received_wire_bytes = traffic.received_bytes;
  return statistics;
}

void DdsChannel::release(const std::string& partition) {
  if (partition.empty()) return;  // what everyone hears
  const std::lock_guard lock(sending_);
  std::erase_if(writers_, [&](const auto& item) { return item.first.second == partition; });
}

bool DdsChannel::wait_for_message(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  return arrived_.wait_for(lock, patience, [this] { return !inbox_.empty(); });
}

int DdsChannel::matched_readers(Topic topic, const std::string& partition) {
  const std::lock_guard lock(sending_);
  dds::PublicationMatchedStatus status;
  writer(topic, partition).get_publication_matched_status(status);
  return status.current_count;
}

ChannelDiagnostics DdsChannel::diagnostics() const {
  const std::lock_guard lock(mutex_);
  return diagnostics_;
}

dds::DataWriter& DdsChannel::writer(Topic topic, const std::string& partition) {
  const auto existing = writers_.find({topic, partition});
  if (existing != writers_.end()) return *existing->second;
  if (!partition.empty() && !is_valid_id(partition)) {
    throw std::invalid_argument("not a partition: '" + partition + "'");
  }
  Writer created = participant_.create_writer(topic_spec(topic), partition);
  return *writers_.emplace(std::pair(topic, partition), std::move(created)).first->second;
}

std::vector<DdsChannel::Subscription> DdsChannel::subscribe(const Config& config) {
  if (!is_valid_id(config.name)) throw TransportError("not a valid name: '" + config.name + "'");
  std::vector<Subscription> subscriptions;
  const auto hear = [&](Topic topic, const std::string& partition) {
    auto reader = participant_.create_reader(topic_spec(topic), partition);
    subscriptions.push_back({.topic = topic, .reader = std::move(reader)});
  };
  if (config.role == ChannelRole::kRobot) {
    hear(Topic::kLocalization, config.name);
    hear(Topic::kCorrection, config.name);
    hear(Topic::kLocalizerStatus, "");
  } else {
    hear(Topic::kSession, "");
    hear(Topic::kSubmap, config.name);
    hear(Topic::kRobotStatus, config.name);
  }
  return subscriptions;
}

bool DdsChannel::take(dds::DataReader& reader) {
  const auto subscription = std::ranges::find_if(
      subscriptions_, [&](const Subscription& one) { return one.reader.get() == &reader; });
  Message message{.topic = subscription->topic, .payload = {}};
  dds::SampleInfo info;
  if (reader.take_next_sample(&message.payload, &info) != ReturnCode_t::RETCODE_OK) return false;
  if (!info.valid_data) return true;
  if (info.instance_handle != undecodable_instance()) {
    deliver(std::move(message));
  } else {
    const std::lock_guard lock(mutex_);
    ++diagnostics_.undecodable;
  }
  return true;
}

void DdsChannel::deliver(Message message) {
  const std::lock_guard lock(mutex_);
  ++statistics_.received_messages;
  statistics_.received_payload_bytes += message.payload.size();
  if (inbox_.size() == kInboxMessages) {
    inbox_.pop_front();
    ++diagnostics_.overflowed;
  }
  inbox_.push_back(std::move(message));
  arrived_.notify_all();
}

}  // namespace fleetloc
