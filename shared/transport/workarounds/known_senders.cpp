#include "shared/transport/workarounds/known_senders.hpp"

#include <algorithm>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kSourcePrefixAt = 8;  // in INFO_SRC

std::optional<std::pair<std::uint32_t, std::int64_t>> highest_number(
    const RtpsSubmessage& submessage) {
  RtpsFields fields = submessage.fields();
  switch (submessage.kind) {
    case RtpsKind::kData:
    case RtpsKind::kDataFrag: {
      fields.skip(4);  // extra flags, offset
      fields.entity();
      const std::uint32_t writer = fields.entity();
      return std::pair(writer, fields.sequence_number());
    }
    case RtpsKind::kHeartbeat:
    case RtpsKind::kGap: {
      fields.entity();
      const std::uint32_t writer = fields.entity();
      fields.sequence_number();
      const std::int64_t end = fields.sequence_number();  // of a gap: behind it
      return std::pair(writer, submessage.kind == RtpsKind::kGap ? end - 1 : end);
    }
    default:
      return std::nullopt;
  }
}

}  // namespace

void KnownSenders::watch(const std::set<GuidPrefix>& servers) {
  const std::lock_guard lock(mutex_);
  servers_ = servers;
}

std::optional<std::uint32_t> KnownSenders::address_of(const GuidPrefix& participant) const {
  const std::lock_guard lock(mutex_);
  const auto known = participants_.find(participant);
  return known == participants_.end() ? std::nullopt : known->second.source;
}

std::size_t KnownSenders::participants() const {
  const std::lock_guard lock(mutex_);
  return participants_.size();
}

// On this computer it sends from 127.0.0.1 to those beside it.
bool KnownSenders::Participant::may_send_from(std::uint32_t address, Time now) const {
  constexpr std::uint32_t kLocalhost = 0x7f000001;
  return !source || source == address || announced.contains(address) || address == kLocalhost ||
         now - heard > kSilence;
}

expected<void, RtpsDefect> KnownSenders::check(RtpsBytes datagram,
                                               std::uint32_t address,
                                               Time now) {
  const std::lock_guard lock(mutex_);
  GuidPrefix from = sender_of(datagram);
  if (const auto valid = check_sender(from, address, now); !valid) return valid;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind == RtpsKind::kInfoSource) {
      std::ranges::copy(submessage->body.subspan(kSourcePrefixAt, from.size()), from.begin());
      if (const auto valid = check_sender(from, address, now); !valid) return valid;
    }
    if (submessage->kind == RtpsKind::kData) {
      if (const auto valid = check_data(*submessage, from, address, now); !valid) return valid;
    }
    if (!passes_numbers(*submessage, from, now)) return unexpected(RtpsDefect::kFarAhead);
  }
  return {};
}

expected<void, RtpsDefect> KnownSenders::check_sender(const GuidPrefix& prefix,
                                                      std::uint32_t address,
                                                      Time now) {
  const auto known = participants_.find(prefix);
  if (known == participants_.end()) return {};
  Participant& participant = known->second;
  if (!participant.may_send_from(address, now)) return unexpected(RtpsDefect::kForeignGuid);
  const bool has_moved = now - participant.heard > kSilence;
  if (!participant.source || has_moved) participant.source = address;
  participant.heard = now;
  return {};
}

expected<void, RtpsDefect> KnownSenders::check_data(const RtpsSubmessage& data,
                                                    const GuidPrefix& from,
                                                    std::uint32_t address,
                                                    Time now) {
  const auto sample = discovery_sample(data);
  if (!sample || !sample->of) return {};
  const GuidPrefix& of = *sample->of;
  const bool is_told_by_server = of != from;
  if (is_told_by_server && !servers_.contains(from)) return unexpected(RtpsDefect::kForeignGuid);
  if (!sample->is_announcement) return {};
  const bool is_new = !participants_.contains(of);
  if (is_new && !add(of, address, now)) return unexpected(RtpsDefect::kTooManySenders);
  Participant& participant = participants_.at(of);
  if (is_new && !is_told_by_server) participant.source = address;
  participant.announced = sample->addresses;
  return {};
}

bool KnownSenders::add(const GuidPrefix& prefix, std::uint32_t address, Time now) {
  if (!newcomers_.spend(address, now)) return false;
  if (participants_.size() >= kMaxParticipants) {
    participants_.erase(std::ranges::min_element(
        participants_, {}, [](const auto& item) { return item.second.heard; }));
  }
  participants_[prefix].heard = now;
  return true;
}

bool KnownSenders::passes_numbers(const RtpsSubmessage& submessage,
                                  const GuidPrefix& from,
                                  Time now) {
  const auto known = participants_.find(from);
  if (known == participants_.end()) return true;  // no reader listens to it
  const auto number = highest_number(submessage);
  return !number || known->second.sequences.passes(number->first, number->second, now);
}

}  // namespace fleetloc
