#include "test/protocol/disturbed_network.hpp"

#include <cmath>

namespace fleetloc {
namespace {

constexpr double kRetransmissionSeconds = 1.0;  // of reliable topics
constexpr std::uint64_t kNobody = 0;

}  // namespace

class DisturbedNetwork::End final : public Channel {
 public:
  End(DisturbedNetwork& network, MemberId id) : network_(network), id_(id) {}
  ~End() override { network_.leave(id_); }
  End(const End&) = delete;
  End& operator=(const End&) = delete;

  void send(const std::string& partition, Message message, Timestamp /*now*/) override {
    network_.send(id_, partition, std::move(message));
  }
  [[nodiscard]] std::vector<Message> receive(Timestamp /*now*/) override {
    return std::exchange(network_.members_.at(id_).inbox, {});
  }
  void release(const std::string& partition) override { network_.last_.erase({id_, partition}); }
  [[nodiscard]] ChannelStatistics statistics() const override { return {}; }

 private:
  DisturbedNetwork& network_;
  MemberId id_;
};

std::unique_ptr<Channel> DisturbedNetwork::join(bool is_robot, const std::string& name) {
  const MemberId id = next_id_++;
  members_[id] = {.is_robot = is_robot, .name = name, .inbox = {}, .newest = {}};
  for (auto& [writer, last] : last_) {
    if (hears(members_.at(id), writer.first, last.message.topic, writer.second)) {
      last.attempts[id] = now_;
    }
  }
  return std::make_unique<End>(*this, id);
}

void DisturbedNetwork::leave(MemberId id) {
  members_.erase(id);
  std::erase_if(last_, [id](const auto& item) { return item.first.first == id; });
  for (auto& [writer, last] : last_) last.attempts.erase(id);
  for (auto& [other, member] : members_) {
    std::erase_if(member.newest, [id](const auto& item) { return item.first.first == id; });
  }
}

bool DisturbedNetwork::hears(const Member& receiver,
                             MemberId sender,
                             Topic topic,
                             const std::string& partition) const {
  if (receiver.is_robot == members_.at(sender).is_robot) return false;
  return topic == Topic::kLocalizerStatus || partition == receiver.name;
}

void DisturbedNetwork::send(MemberId sender, const std::string& partition, Message message) {
  const std::uint64_t number = next_number_++;
  if (is_reliable(message.topic)) {
    Last& last = last_[{sender, partition}];
    last = {.number = number, .message = std::move(message), .attempts = {}};
    for (const auto& [id, member] : members_) {
      if (hears(member, sender, last.message.topic, partition)) last.attempts[id] = now_;
    }
    return;
  }
  for (const auto& [id, member] : members_) {
    if (!hears(member, sender, message.topic, partition)) continue;
    if (uniform() >= disturbance_.loss) transfer({sender, id, number, message});
  }
}

void DisturbedNetwork::inject(bool to_robot, const std::string& receiver, Message message) {
  for (const auto& [id, member] : members_) {
    if (member.is_robot == to_robot && member.name == receiver) {
      transfer({kNobody, id, next_number_++, message});
    }
  }
}

void DisturbedNetwork::transfer(const Delivery& delivery) {
  const int copies = uniform() < disturbance_.duplication ? 2 : 1;
  for (int i = 0; i < copies; ++i) {
    const double extra_s = -disturbance_.jitter_s * std::log(1.0 - uniform());
    under_way_.emplace(now_ + from_seconds(disturbance_.delay_s + extra_s), delivery);
  }
}

void DisturbedNetwork::advance(Timestamp now) {
  now_ = now;
  for (auto& [writer, last] : last_) {
    for (auto attempt = last.attempts.begin(); attempt != last.attempts.end();) {
      if (attempt->second > now_) {
        ++attempt;
      } else if (uniform() < disturbance_.loss) {
        attempt++->second = now_ + from_seconds(kRetransmissionSeconds);
      } else {
        transfer({writer.first, attempt->first, last.number, last.message});
        attempt = last.attempts.erase(attempt);
      }
    }
  }
  while (!under_way_.empty() && under_way_.begin()->first <= now_) {
    deliver(std::move(under_way_.extract(under_way_.begin()).mapped()));
  }
}

void DisturbedNetwork::deliver(Delivery delivery) {
  const auto receiver = members_.find(delivery.receiver);
  if (receiver == members_.end()) return;
  const Topic topic = delivery.message.topic;
  if (delivery.sender != kNobody && (is_reliable(topic) || disturbance_.drops_late)) {
    std::uint64_t& newest = receiver->second.newest[{delivery.sender, topic}];
    if (delivery.number <= newest) return;
    newest = delivery.number;
  }
  receiver->second.inbox.push_back(std::move(delivery.message));
}

}  // namespace fleetloc
