#include "shared/transport/workarounds/announcement_repetition.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

constexpr std::chrono::milliseconds kFirstRepetition{500};
constexpr int kTries = 5;                               // within 16 s
constexpr int kTriesToAll = 40;                         // within 40 to 320 s
constexpr std::chrono::minutes kStrangerForgotten{10};  // longer than any lease
constexpr std::size_t kManyStrangers = 8192;            // as KnownSenders
constexpr std::chrono::seconds kBetweenLooks{1};        // for those that are forgotten

bool is_addressed(RtpsBytes datagram, const GuidPrefix& to) {
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind == RtpsKind::kInfoDestination &&
        std::ranges::equal(submessage->body, to)) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::optional<AnnouncementRepetition::Pause> AnnouncementRepetition::heard(RtpsBytes datagram,
                                                                           const GuidPrefix& own,
                                                                           Time now) {
  const bool knows_us = is_addressed(datagram, own);
  if (knows_us) is_known_.store(true, std::memory_order_relaxed);
  const std::lock_guard lock(mutex_);
  const auto known = strangers_.find(sender_of(datagram));
  if (known != strangers_.end()) {
    known->second.heard = now;
    known->second.knows_us |= knows_us;
    return std::nullopt;
  }
  if (!knows_us && !is_announcement(datagram)) return std::nullopt;
  if (!has_room(now)) return std::nullopt;
  strangers_[sender_of(datagram)] = {.heard = now, .knows_us = knows_us};
  return knows_us ? std::nullopt : std::optional<Pause>(kFirstRepetition);
}

bool AnnouncementRepetition::has_room(Time now) {
  if (strangers_.size() < kManyStrangers) return true;
  if (now - made_room_ < kBetweenLooks) return false;
  made_room_ = now;
  std::erase_if(strangers_,
                [&](const auto& one) { return now - one.second.heard > kStrangerForgotten; });
  return strangers_.size() < kManyStrangers;
}

std::optional<AnnouncementRepetition::Due> AnnouncementRepetition::again(
    const GuidPrefix& participant) {
  const std::lock_guard lock(mutex_);
  const auto known = strangers_.find(participant);
  if (known == strangers_.end() || known->second.knows_us) return std::nullopt;
  if (++known->second.tries > kTries) return std::nullopt;
  const int doubled = 1 << known->second.tries;
  return Due{.copies = std::min(doubled, max_copies_), .next = doubled * kFirstRepetition};
}

std::optional<AnnouncementRepetition::Pause> AnnouncementRepetition::again_to_all() {
  if (is_known() || ++tries_to_all_ > kTriesToAll) return std::nullopt;
  const std::lock_guard lock(mutex_);
  return strangers_.empty() ? kFirstToAll : 8 * kFirstToAll;
}

}  // namespace fleetloc
