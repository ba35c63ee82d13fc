#include "shared/link/memory_network.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "shared/link/best_effort_reader.hpp"
#include "shared/link/datagrams.hpp"
#include "shared/link/link_model.hpp"

namespace fleetloc {
namespace {

using MemberId = std::uint64_t;  // in order of joining

struct Sample {
  std::uint64_t number;  // in the order of sending
  Message message;
};

// One that is on its way. It shares the reader, which goes when its sender leaves.
struct Datagram {
  std::size_t wire_bytes;
  std::shared_ptr<const Sample> sample;
  std::size_t fragment, fragments;
  std::shared_ptr<BestEffortReader> reader;
};

struct RobotLinks {
  LinkModel uplink, downlink;
};

struct Member {
  bool is_robot;
  std::string name;
  RobotLinks links;  // used for robots
  std::multimap<Timestamp, Datagram> inbox;
  std::map<std::pair<MemberId, Topic>, std::shared_ptr<BestEffortReader>> readers;  // of whom
  ChannelStatistics statistics;
};

bool hears(const Member& receiver,
           const Member& sender,
           Topic topic,
           const std::string& partition) {
  if (receiver.is_robot == sender.is_robot) return false;
  switch (topic) {
    case Topic::kSession:
    case Topic::kSubmap:
    case Topic::kCompactSubmap:
    case Topic::kRobotStatus:
      return !receiver.is_robot && partition == receiver.name;
    case Topic::kLocalization:
      return receiver.is_robot && partition == receiver.name;
    case Topic::kLocalizerStatus:
      return receiver.is_robot;
  }
  return false;
}

// FNV-1a: the links of two robots differ, whoever joins first.
std::uint64_t seed_of(std::uint64_t seed, std::string_view name, std::uint64_t direction) {
  std::uint64_t hash = 0xcbf29ce484222325U ^ seed;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3U;
  return (hash ^ direction) * 0x100000001b3U;
}

}  // namespace

class MemoryNetwork::State {
 public:
  State(const LinkConfig& link, Links links)
      : link_(link),
        shared_(links == Links::kShared ? std::optional(links_of("")) : std::nullopt) {}

  MemberId join(bool is_robot, const std::string& name) {
    const MemberId id = next_id_++;
    members_.emplace(id,
                     Member{.is_robot = is_robot,
                            .name = name,
                            .links = links_of(name),
                            .inbox = {},
                            .readers = {},
                            .statistics = {}});
    for (auto& [key, last] : last_) await(key, last, id);
    return id;
  }

  void leave(MemberId id) {
    members_.erase(id);
    std::erase_if(last_, [&](const auto& item) { return item.first.sender == id; });
    for (auto& [key, last] : last_) last.next_attempt.erase(id);
    for (auto& [other, member] : members_) {
      std::erase_if(member.readers, [&](const auto& item) { return item.first.first == id; });
    }
  }

  void send(MemberId sender, const std::string& partition, Message message, Timestamp now) {
    advance(now);
    ChannelStatistics& statistics = members_.at(sender).statistics;
    ++statistics.sent_messages;
    statistics.sent_payload_bytes += message.payload.size();
    const auto sample = std::make_shared<const Sample>(Sample{++samples_, std::move(message)});
    const Topic topic = sample->message.topic;
    if (!is_reliable(topic)) {
      for (const auto& [id, member] : members_) {
        if (!hears(member, members_.at(sender), topic, partition)) continue;
        transfer(sender, id, sample, now);
      }
      return;
    }
    const Key key{sender, topic, partition};
    Last& last = last_[key] = {.sample = sample, .next_attempt = {}};
    for (const auto& [id, member] : members_) await(key, last, id);
    advance(now);
  }

  void release(MemberId sender, const std::string& partition) {
    std::erase_if(last_, [&](const auto& item) {
      return item.first.sender == sender && item.first.partition == partition;
    });
  }

  std::vector<Message> receive(MemberId receiver, Timestamp now) {
    advance(now);
    Member& member = members_.at(receiver);
    std::vector<Message> messages;
    const auto end = member.inbox.upper_bound(now);
    for (auto it = member.inbox.begin(); it != end; it = member.inbox.erase(it)) {
      const Datagram& datagram = it->second;
      const Sample& sample = *datagram.sample;
      member.statistics.received_wire_bytes += datagram.wire_bytes;
      if (!datagram.reader->receive(sample.number, datagram.fragment, datagram.fragments)) continue;
      ++member.statistics.received_messages;
      member.statistics.received_payload_bytes += sample.message.payload.size();
      messages.push_back(sample.message);
    }
    return messages;
  }

  [[nodiscard]] ChannelStatistics statistics(MemberId id) const {
    return members_.at(id).statistics;
  }

 private:
  struct Key {
    MemberId sender;
    Topic topic;
    std::string partition;
    auto operator<=>(const Key&) const = default;  // NOLINT(modernize-use-nullptr)
  };
  struct Attempt {
    Timestamp time;
    Key key;
    MemberId receiver;
  };
  struct Last {
    std::shared_ptr<const Sample> sample;
    std::map<MemberId, Timestamp> next_attempt;  // for those it has not reached yet
  };

  [[nodiscard]] RobotLinks links_of(std::string_view name) const {
    return {.uplink = {link_.uplink, seed_of(link_.seed, name, 1)},
            .downlink = {link_.downlink, seed_of(link_.seed, name, 2)}};
  }

  void await(const Key& key, Last& last, MemberId receiver) {
    const Member& sender = members_.at(key.sender);
    if (hears(members_.at(receiver), sender, key.topic, key.partition)) {
      last.next_attempt[receiver] = now_;
    }
  }

  // Makes all attempts that are due until `now`, in order of time.
  void advance(Timestamp now) {
    now_ = std::max(now_, now);
    while (const std::optional<Attempt> next = next_attempt()) {
      if (next->time > now_) return;
      Last& last = last_.at(next->key);
      if (transfer(next->key.sender, next->receiver, last.sample, next->time)) {
        last.next_attempt.erase(next->receiver);
      } else {
        last.next_attempt[next->receiver] = next->time + kRetransmission;
      }
    }
  }

  [[nodiscard]] std::optional<Attempt> next_attempt() const {
    std::optional<Attempt> next;
    for (const auto& [key, last] : last_) {
      for (const auto& [receiver, time] : last.next_attempt) {
        if (!next || time < next->time) next = Attempt{time, key, receiver};
      }
    }
    return next;
  }

  // Puts a sample on the link. True if all of it arrives.
  bool transfer(MemberId from,
                MemberId to,
                const std::shared_ptr<const Sample>& sample,
                Timestamp now) {
    Member& sender = members_.at(from);
    Member& receiver = members_.at(to);
    Member& robot = sender.is_robot ? sender : receiver;
    RobotLinks& links = shared_ ? *shared_ : robot.links;
    links.uplink.start(now);
    links.downlink.start(now);
    LinkModel& link = sender.is_robot ? links.uplink : links.downlink;
    auto& reader = receiver.readers[{from, sample->message.topic}];
    if (!reader) reader = std::make_shared<BestEffortReader>();
    const std::vector<std::size_t> sizes = datagram_sizes(sample->message.payload.size());
    bool is_complete = true;
    for (std::size_t i = 0; i < sizes.size(); ++i) {
      sender.statistics.sent_wire_bytes += sizes[i];
      const std::vector<Timestamp> arrivals = link.arrivals(now, sizes[i]);
      is_complete = is_complete && !arrivals.empty();
      for (const Timestamp arrival : arrivals) {
        receiver.inbox.emplace(arrival, Datagram{sizes[i], sample, i, sizes.size(), reader});
      }
    }
    return is_complete;
  }

  LinkConfig link_;
  std::optional<RobotLinks> shared_;
  Timestamp now_{Timestamp::min()};
  MemberId next_id_ = 0;
  std::uint64_t samples_ = 0;
  std::map<MemberId, Member> members_;
  std::map<Key, Last> last_;  // of the reliable topics
};

class MemoryNetwork::End final : public Channel {
 public:
  End(std::shared_ptr<State> state, MemberId id) : state_(std::move(state)), id_(id) {}
  ~End() override { state_->leave(id_); }
  End(const End&) = delete;
  End& operator=(const End&) = delete;

  void send(const std::string& partition, Message message, Timestamp now) override {
    state_->send(id_, partition, std::move(message), now);
  }
  [[nodiscard]] std::vector<Message> receive(Timestamp now) override {
    return state_->receive(id_, now);
  }
  void release(const std::string& partition) override { state_->release(id_, partition); }
  [[nodiscard]] ChannelStatistics statistics() const override { return state_->statistics(id_); }

 private:
  std::shared_ptr<State> state_;
  MemberId id_;
};

MemoryNetwork::MemoryNetwork(const LinkConfig& link, Links links)
    : state_(std::make_shared<State>(link, links)) {}

std::unique_ptr<Channel> MemoryNetwork::join(bool is_robot, const std::string& name) {
  return std::make_unique<End>(state_, state_->join(is_robot, name));
}

std::unique_ptr<Channel> MemoryNetwork::join_robot(const std::string& robot) {
  return join(true, robot);
}

std::unique_ptr<Channel> MemoryNetwork::join_cloud(const std::string& localizer) {
  return join(false, localizer);
}

}  // namespace fleetloc
