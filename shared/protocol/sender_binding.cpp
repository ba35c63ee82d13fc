#include "shared/protocol/sender_binding.hpp"

namespace fleetloc {
namespace {

constexpr double kLookForRoomSeconds = 1.0;  // it takes a while, and strangers may ask often

}  // namespace

bool SenderBinding::accepts(const std::string& id, const MessageSender& sender, Timestamp now) {
  if (!sender.is_known()) return true;
  const auto other = spoken_for_.find(sender.participant);
  if (other != spoken_for_.end() && other->second != id) return false;
  const auto bound = bound_.find(id);
  if (bound == bound_.end()) {
    if (!has_room(now)) return false;
  } else if (!is_free(bound->second, sender, now)) {
    return false;
  } else {
    spoken_for_.erase(bound->second.sender.participant);
  }
  bound_[id] = {.sender = sender, .heard = now};
  spoken_for_[sender.participant] = id;
  return true;
}

bool SenderBinding::accepts_if_bound(const std::string& id,
                                     const MessageSender& sender,
                                     Timestamp now) {
  return !bound_.contains(id) || accepts(id, sender, now);
}

bool SenderBinding::is_free(const Bound& bound, const MessageSender& sender, Timestamp now) const {
  return bound.sender.is_same_program(sender) || bound.sender.is_same_computer(sender) ||
         to_seconds(now - bound.heard) > silence_s_;
}

bool SenderBinding::has_room(Timestamp now) {
  if (bound_.size() < kMaxIds) return true;
  const bool has_just_looked = looked_for_room_ != Timestamp::min() &&
                               to_seconds(now - looked_for_room_) < kLookForRoomSeconds;
  if (has_just_looked) return false;
  looked_for_room_ = now;
  std::erase_if(bound_, [&](const auto& item) {
    const bool is_silent = to_seconds(now - item.second.heard) > silence_s_;
    if (is_silent) spoken_for_.erase(item.second.sender.participant);
    return is_silent;
  });
  return bound_.size() < kMaxIds;
}

}  // namespace fleetloc
