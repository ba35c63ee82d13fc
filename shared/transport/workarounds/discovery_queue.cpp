#include "shared/transport/workarounds/discovery_queue.hpp"

#include <algorithm>
#include <utility>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kMostWaiting = 2000;  // then new ones are dropped, as on a full link
constexpr std::size_t kMostSaid = 4000;
constexpr milliseconds kSavedUp{500};
// After it has gone out, which takes its length: the round trip, and what is on the line before it
// or its answer.
constexpr milliseconds kRestOfHandshake{3000};

}  // namespace

bool DiscoveryQueue::has_just_said(const RepeatedDatagram& datagram, Time now) {
  const std::lock_guard lock(mutex_);
  const auto said = said_until_.find(datagram.statement);
  return said != said_until_.end() && now < said->second;
}

bool DiscoveryQueue::passes(const RepeatedDatagram& datagram, std::size_t bytes, Time now) {
  const std::lock_guard lock(mutex_);
  if (is_due_ || free_at_ > now) return false;
  sent(datagram, bytes, now);
  return true;
}

void DiscoveryQueue::sent(const RepeatedDatagram& datagram, std::size_t bytes, Time now) {
  const auto lasts = std::chrono::duration_cast<Time::duration>(
      std::chrono::duration<double>(static_cast<double>(bytes) / bytes_per_s_));
  free_at_ = std::max(free_at_, now - kSavedUp) + lasts;
  if (said_until_.size() > kMostSaid) {
    std::erase_if(said_until_, [&](const auto& item) { return item.second <= now; });
  }
  Time::duration pause = datagram.worth_repeating_after;
  if (datagram.is_handshake) pause = lasts + kRestOfHandshake;
  said_until_[datagram.statement] = now + pause;
}

std::optional<DiscoveryQueue::Time> DiscoveryQueue::put(RepeatedDatagram datagram,
                                                        std::size_t bytes,
                                                        std::function<void()> send,
                                                        Time now) {
  const std::lock_guard lock(mutex_);
  const auto same = std::ranges::find_if(
      waiting_, [&](const Waiting& one) { return one.datagram.subject == datagram.subject; });
  if (same != waiting_.end()) {
    *same = {std::move(datagram), bytes, std::move(send)};
  } else if (waiting_.size() < kMostWaiting) {
    const auto place = datagram.is_secure ? behind_secure() : waiting_.end();
    waiting_.insert(place, {std::move(datagram), bytes, std::move(send)});
  }
  if (std::exchange(is_due_, true)) return std::nullopt;
  free_at_ = std::max(free_at_, now - kSavedUp);
  return std::max(free_at_, now);
}

// Announcements of a participant that has secure ones are many, and long, while it has few
// partners.
std::deque<DiscoveryQueue::Waiting>::iterator DiscoveryQueue::behind_secure() {
  const auto is_secure = [](const Waiting& one) { return one.datagram.is_secure; };
  return std::find_if(waiting_.rbegin(), waiting_.rend(), is_secure).base();
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
