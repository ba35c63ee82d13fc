#include "shared/transport/workarounds/discovery_queue.hpp"

#include <algorithm>
#include <utility>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kMostWaiting = 2000;  // then new ones are dropped, as on a full link
constexpr std::size_t kMostSaid = 4000;
constexpr std::uint32_t kBuiltIn = 0xC0;  // in the kind of an entity (RTPS 2.2, table 9.1)
constexpr milliseconds kSavedUp{500};
// Of the round trips of links that need a limit; the library repeats all of them when asked, and
// participants every time that they discover another one.
constexpr milliseconds kOfParticipant{2000};
constexpr milliseconds kOfEndpoint{1000};
constexpr milliseconds kOther{500};

void append(RtpsBytes bytes, std::vector<std::uint8_t>& to) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// @return whether the submessage is of discovery, or tells nothing
bool add(const RtpsSubmessage& submessage, DiscoveryDatagram& datagram) {
  std::size_t skipped = 0;  // before reader and writer
  std::size_t said = 0;     // behind them; of an ACKNACK and a GAP all but the count
  switch (submessage.kind) {
    case RtpsKind::kPad:
    case RtpsKind::kInfoTimestamp:
    case RtpsKind::kStatistics:
      return true;
    case RtpsKind::kInfoDestination:
      append(submessage.body, datagram.subject);
      append(submessage.body, datagram.statement);
      return true;
    case RtpsKind::kData:
      skipped = 4;
      said = 8;
      break;
    case RtpsKind::kHeartbeat:
      said = 16;
      break;
    case RtpsKind::kAckNack:
      said = submessage.body.size() - std::min<std::size_t>(submessage.body.size(), 12);
      break;
    case RtpsKind::kGap:
      said = submessage.body.size() - std::min<std::size_t>(submessage.body.size(), 8);
      break;
    default:
      return false;
  }
  if (submessage.body.size() < skipped + kEntitiesBytes + said) return false;
  const RtpsBytes entities = submessage.body.subspan(skipped, kEntitiesBytes);
  RtpsFields fields(entities.last(4), true);
  const std::uint32_t writer = fields.entity();
  if ((writer & kBuiltIn) != kBuiltIn) return false;
  const bool is_data = submessage.kind == RtpsKind::kData;
  for (auto* part : {&datagram.subject, &datagram.statement}) {
    part->push_back(static_cast<std::uint8_t>(submessage.kind));
    if (part == &datagram.statement) part->push_back(submessage.flags);
    append(entities, *part);
    if (is_data || part == &datagram.statement) {
      append(submessage.body.subspan(skipped + kEntitiesBytes, said), *part);
    }
  }
  const milliseconds pause = writer == kParticipantWriter ? kOfParticipant
                             : is_data                    ? kOfEndpoint
                                                          : kOther;
  datagram.worth_repeating_after = std::max(datagram.worth_repeating_after, pause);
  return true;
}

}  // namespace

std::optional<DiscoveryDatagram> DiscoveryDatagram::read(RtpsBytes datagram) {
  if (datagram.size() < kRtpsHeaderBytes) return std::nullopt;
  DiscoveryDatagram read;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (!rest.empty()) {
    const auto submessage = take_submessage(rest);
    if (!submessage || !add(*submessage, read)) return std::nullopt;
  }
  if (read.worth_repeating_after == milliseconds{}) return std::nullopt;
  return read;
}

void DiscoveryDatagram::address_to(const void* socket, const PeerAddressFilter::Locator& to) {
  const auto append = [this](const auto& value) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    for (auto* part : {&subject, &statement})
      part->insert(part->end(), bytes, bytes + sizeof(value));
  };
  append(socket);
  append(to.address);
  append(to.port);
}

bool DiscoveryQueue::has_just_said(const DiscoveryDatagram& datagram, Time now) {
  const std::lock_guard lock(mutex_);
  const auto said = said_until_.find(datagram.statement);
  return said != said_until_.end() && now < said->second;
}

bool DiscoveryQueue::passes(const DiscoveryDatagram& datagram, std::size_t bytes, Time now) {
  const std::lock_guard lock(mutex_);
  if (is_due_ || free_at_ > now) return false;
  sent(datagram, bytes, now);
  return true;
}

void DiscoveryQueue::sent(const DiscoveryDatagram& datagram, std::size_t bytes, Time now) {
  const std::chrono::duration<double> lasts(static_cast<double>(bytes) / bytes_per_s_);
  free_at_ = std::max(free_at_, now - kSavedUp) + std::chrono::duration_cast<Time::duration>(lasts);
  if (said_until_.size() > kMostSaid) {
    std::erase_if(said_until_, [&](const auto& item) { return item.second <= now; });
  }
  said_until_[datagram.statement] = now + datagram.worth_repeating_after;
}

std::optional<DiscoveryQueue::Time> DiscoveryQueue::put(DiscoveryDatagram datagram,
                                                        std::size_t bytes,
                                                        std::function<void()> send,
                                                        Time now) {
  const std::lock_guard lock(mutex_);
  const auto same = std::ranges::find_if(
      waiting_, [&](const Waiting& one) { return one.datagram.subject == datagram.subject; });
  if (same != waiting_.end()) {
    *same = {std::move(datagram), bytes, std::move(send)};
  } else if (waiting_.size() < kMostWaiting) {
    waiting_.push_back({std::move(datagram), bytes, std::move(send)});
  }
  if (std::exchange(is_due_, true)) return std::nullopt;
  free_at_ = std::max(free_at_, now - kSavedUp);
  return std::max(free_at_, now);
}

DiscoveryQueue::Taken DiscoveryQueue::take(Time now) {
  const std::lock_guard lock(mutex_);
  is_due_ = false;
  if (waiting_.empty()) return {};
  const Waiting first = std::move(waiting_.front());
  waiting_.pop_front();
  sent(first.datagram, first.bytes, now);
  is_due_ = !waiting_.empty();
  return {.send = first.send,
          .next = is_due_ ? std::optional(std::max(free_at_, now)) : std::nullopt};
}

}  // namespace fleetloc
