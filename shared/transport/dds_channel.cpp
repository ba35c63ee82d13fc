#include "shared/transport/dds_channel.hpp"

#include <iterator>
#include <stdexcept>
#include <utility>

#include <fastdds/dds/core/status/PublicationMatchedStatus.hpp>

#include "shared/core/ids.hpp"

namespace fleetloc {

namespace {

using std::chrono::milliseconds;

// Far more than one cycle of any program leaves.
constexpr std::size_t kInboxMessages = 4096;
constexpr std::size_t kInboxBytes = 16U << 20U;
constexpr std::size_t kMaxEvents = 100;      // further ones are dropped
constexpr milliseconds kLook{1000};          // period of checks without a notification
constexpr milliseconds kLookAgain{50};       // while it changes
constexpr milliseconds kFirstLookup{500};    // of peers, that a program's start waits for
constexpr std::chrono::seconds kAlone{5};    // then localizers of other versions are sought
constexpr std::chrono::seconds kAbsent{60};  // then a localizer's writers to a robot are deleted
constexpr std::size_t kMaxPrepared = 8192;   // writers; others are made when they are needed

void check(Topic topic, const std::string& receiver) {
  if (topic == Topic::kLocalizerStatus ? receiver.empty() : is_valid_id(receiver)) return;
  throw std::invalid_argument("not a receiver: '" + receiver + "'");
}

/// What an end sends to each of its receivers.
std::vector<Topic> topics_from(ChannelRole role) {
  if (role == ChannelRole::kCloud) return {Topic::kLocalization};
  return {Topic::kSession, Topic::kCompactSubmap, Topic::kRobotStatus};
}

}  // namespace

DdsChannel::DdsChannel(const Config& config)
    : config_(config),
      wire_(std::make_shared<WireLink>(config.role, config.link)),
      lookup_(named_peers(config.participant_profile)),
      presence_(kAbsent),
      connection_(connect({.predecessor = {}, .peers = lookup_.find(kFirstLookup)})),
      watch_([this](const std::stop_token& stop) { watch(stop); }) {}

std::unique_ptr<DdsConnection> DdsChannel::connect(ParticipantOptions options) {
  options.keys = config_.keys;
  if (options.keys) {
    const bool is_robot = config_.role == ChannelRole::kRobot;
    options.keys->require(is_robot ? FleetRole::kRobot : FleetRole::kLocalizer, config_.name);
  }
  return std::make_unique<DdsConnection>(
      config_, wire_, options, [this](expected<Message, KeyDefect> message) {
        deliver(std::move(message));
      });
}

void DdsChannel::send(const std::string& receiver, Message message, Timestamp /*now*/) {
  check(message.topic, receiver);
  const std::size_t size = message.payload.size();
  const Destination destination{message.topic, receiver};
  bool connected = false;
  bool sent = false;
  {
    const std::lock_guard lock(sending_);
    destinations_.insert(destination);
    connected = connection_ != nullptr;
    sent = connected && connection_->writer(destination).write(&message.payload);
    if (is_reliable(message.topic)) last_reliable_[destination] = std::move(message);
  }
  const std::lock_guard lock(mutex_);
  ++statistics_.sent_messages;
  statistics_.sent_payload_bytes += size;
  if (!connected) ++diagnostics_.unsent;
  if (connected && !sent) ++diagnostics_.refused;
}

std::vector<Message> DdsChannel::receive(Timestamp /*now*/) {
  const std::lock_guard lock(mutex_);
  std::vector<Message> messages(std::make_move_iterator(inbox_.begin()),
                                std::make_move_iterator(inbox_.end()));
  inbox_.clear();
  inbox_bytes_ = 0;
  return messages;
}

ChannelStatistics DdsChannel::statistics() const {
  const WireTraffic traffic = wire_->traffic.total();
  const std::lock_guard lock(mutex_);
  ChannelStatistics statistics = statistics_;
  statistics.sent_wire_bytes = traffic.sent_bytes;
  statistics.received_wire_bytes = traffic.received_bytes;
  return statistics;
}

void DdsChannel::prepare(const std::string& receiver) {
  const std::lock_guard lock(sending_);
  for (const Topic topic : topics_from(config_.role)) {
    check(topic, receiver);
    if (destinations_.size() >= kMaxPrepared) return;
    destinations_.insert({topic, receiver});
    if (connection_) connection_->writer({topic, receiver});
  }
}

void DdsChannel::release(const std::string& receiver) {
  if (receiver.empty()) return;  // the topic for all robots
  const std::lock_guard lock(sending_);
  delete_writers(receiver);
}

void DdsChannel::delete_writers(const std::string& receiver) {
  std::erase_if(destinations_, [&](const Destination& one) { return one.second == receiver; });
  std::erase_if(last_reliable_, [&](const auto& one) { return one.first.second == receiver; });
  if (connection_) connection_->release(receiver);
}

void DdsChannel::release_absent(std::chrono::steady_clock::time_point now) {
  const std::lock_guard lock(sending_);
  if (!connection_) return;
  std::set<std::string> receivers;
  for (const auto& [topic, receiver] : destinations_) {
    if (!receiver.empty()) receivers.insert(receiver);
  }
  for (const std::string& receiver : presence_.absent(receivers, connection_->present(), now)) {
    delete_writers(receiver);
  }
}

bool DdsChannel::wait_for_message(milliseconds patience) {
  std::unique_lock lock(mutex_);
  arrived_.wait_for(lock, patience, [this] { return is_woken_ || !inbox_.empty(); });
  is_woken_ = false;
  return !inbox_.empty();
}

void DdsChannel::wake() {
  const std::lock_guard lock(mutex_);
  is_woken_ = true;
  arrived_.notify_all();
}

int DdsChannel::matched_readers(Topic topic, const std::string& receiver) {
  check(topic, receiver);
  const std::lock_guard lock(sending_);
  destinations_.insert({topic, receiver});
  if (!connection_) return 0;
  eprosima::fastdds::dds::PublicationMatchedStatus status;
  connection_->writer({topic, receiver}).get_publication_matched_status(status);
  return status.current_count;
}

ChannelDiagnostics DdsChannel::diagnostics() const {
  const std::lock_guard lock(mutex_);
  ChannelDiagnostics result = diagnostics_;
  result.malformed = wire_->malformed.counts();
  return result;
}

std::vector<std::string> DdsChannel::take_events() {
  const std::lock_guard lock(mutex_);
  return std::exchange(events_, {});
}

void DdsChannel::note(std::string event) {
  const std::lock_guard lock(mutex_);
  if (events_.size() < kMaxEvents) events_.push_back(std::move(event));
}

void DdsChannel::deliver(expected<Message, KeyDefect> message) {
  const std::lock_guard lock(mutex_);
  if (!message) {
    ++diagnostics_.undecodable[std::string(name(message.error()))];
    return;
  }
  ++statistics_.received_messages;
  statistics_.received_payload_bytes += message->payload.size();
  inbox_bytes_ += message->payload.size();
  inbox_.push_back(std::move(*message));
  while (inbox_.size() > kInboxMessages || inbox_bytes_ > kInboxBytes) {
    inbox_bytes_ -= inbox_.front().payload.size();
    inbox_.pop_front();
    ++diagnostics_.overflowed;
  }
  arrived_.notify_all();
}

// Only this thread replaces the connection.
void DdsChannel::watch(const std::stop_token& stop) {
  using Clock = ParticipantRecreationPolicy::Clock;
  const Participant& first = connection_->participant();
  const std::vector<std::string> whitelist = first.whitelist();
  ParticipantOptions options{.predecessor = first.identity(), .peers = first.peers()};
  ParticipantRecreationPolicy policy(
      {.lease = first.lease(), .announcements = first.announcement_period()});
  policy.made({.addresses = first.bound_addresses(), .peers = first.peers()}, Clock::now());
  bool was_cut_off = false;
  while (!stop.stop_requested()) {
    wait_and_look(policy, whitelist, stop);
    if (policy.is_cut_off() && !was_cut_off) note("the network is gone");
    was_cut_off = policy.is_cut_off();
    const auto reason = policy.due(Clock::now());
    if (!reason || stop.stop_requested()) continue;
    options.peers = policy.peers();
    if (recreate(*reason, options)) {
      const Participant& made = connection_->participant();
      policy.made({.addresses = made.bound_addresses(), .peers = made.peers()}, Clock::now());
    } else {
      policy.failed(Clock::now());
    }
  }
}

void DdsChannel::wait_and_look(ParticipantRecreationPolicy& policy,
                               const std::vector<std::string>& whitelist,
                               const std::stop_token& stop) {
  using Clock = ParticipantRecreationPolicy::Clock;
  const auto lost = addresses_.wait(policy.is_unsettled() ? kLookAgain : kLook, stop);
  policy.lost(lost, Clock::now());
  policy.observe({.addresses = interface_addresses(whitelist),
                  .heard = signs_of_life(),
                  .is_expecting = expects_somebody()},
                 Clock::now());
  if (const auto found = lookup_.take()) policy.found(*found, Clock::now());
  if (wire_->servers.has_restarted()) policy.server_restarted();
  if (policy.wants_lookup(Clock::now())) lookup_.start();
  look_for_other_versions(Clock::now());
  if (config_.role == ChannelRole::kCloud) release_absent(Clock::now());
  for (std::string& event : wire_->versions.take_events()) note(std::move(event));
}

// Localizers tell every robot their status, but a robot speaks to the localizer that it uses only:
// another one hears no more than its announcements.
std::uint64_t DdsChannel::signs_of_life() const {
  if (config_.role == ChannelRole::kRobot) return statistics().received_messages;
  return wire_->traffic.total().received_datagrams;
}

// A robot always needs a localizer; a localizer may be idle.
bool DdsChannel::expects_somebody() {
  if (config_.role == ChannelRole::kRobot) return true;
  const std::lock_guard lock(sending_);
  return connection_ && !connection_->present().empty();
}

void DdsChannel::look_for_other_versions(std::chrono::steady_clock::time_point now) {
  const std::lock_guard lock(sending_);
  if (!connection_ || !connection_->is_alone()) {
    alone_since_.reset();
  } else if (!alone_since_) {
    alone_since_ = now;
  } else if (now - *alone_since_ > kAlone) {
    connection_->seek_other_versions();
  }
}

// The old one is deleted first: the new one needs its ports.
bool DdsChannel::recreate(const std::string& reason, ParticipantOptions& options) {
  std::unique_ptr<DdsConnection> old;
  std::set<Destination> destinations;
  {
    const std::lock_guard lock(sending_);
    old = std::move(connection_);
    destinations = destinations_;
  }
  old.reset();
  std::unique_ptr<DdsConnection> fresh;
  try {
    try {
      fresh = connect(options);
    } catch (const TransportError&) {  // possibly because of the identity
      fresh = connect({.predecessor = std::nullopt, .peers = options.peers});
    }
    options.predecessor = fresh->participant().identity();
    for (const Destination& destination : destinations) fresh->writer(destination);
  } catch (const TransportError& error) {
    note(reason + ": no new participant: " + error.what());
    return false;
  }
  {
    const std::lock_guard lock(sending_);
    for (const Destination& destination : destinations) {
      if (!destinations_.contains(destination)) fresh->release(destination.second);
    }
    for (auto& [destination, message] : last_reliable_) {
      fresh->writer(destination).write(&message.payload);
    }
    connection_ = std::move(fresh);
  }
  const std::lock_guard lock(mutex_);
  ++diagnostics_.recreations;
  if (events_.size() < kMaxEvents) events_.push_back(reason + ": a new participant was made");
  return true;
}

}  // namespace fleetloc
