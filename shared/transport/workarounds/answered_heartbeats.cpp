#include "shared/transport/workarounds/answered_heartbeats.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

constexpr std::size_t kHeartbeatBytes = 4 + 28;  // with the head of the submessage

}  // namespace

void AnsweredHeartbeats::watch(const ServerLocators& servers) {
  const std::lock_guard lock(mutex_);
  servers_ = servers;
  acknowledged_.clear();
  is_watching_ = !servers.empty();
}

void AnsweredHeartbeats::observe(RtpsBytes datagram) {
  if (!is_watching_) return;
  const GuidPrefix from = sender_of(datagram);
  const std::lock_guard lock(mutex_);
  if (!servers_.contains(from)) return;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind != RtpsKind::kAckNack) continue;
    RtpsFields fields = submessage->fields();
    fields.entity();  // reader
    const std::uint32_t writer = fields.entity();
    const std::int64_t first_missing = fields.sequence_number();
    acknowledged_[{from, writer}] = first_missing - 1;
  }
}

bool AnsweredHeartbeats::includes(RtpsBytes datagram,
                                  const PeerAddressFilter::Locator& destination) {
  if (!is_watching_ || datagram.size() != kRtpsHeaderBytes + kHeartbeatBytes) return false;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  const auto submessage = take_submessage(rest);
  if (!submessage || submessage->kind != RtpsKind::kHeartbeat) return false;
  RtpsFields fields = submessage->fields();
  fields.entity();  // reader
  const std::uint32_t writer = fields.entity();
  fields.sequence_number();
  const std::int64_t last = fields.sequence_number();
  const std::lock_guard lock(mutex_);
  const auto server = std::ranges::find_if(
      servers_, [&](const auto& one) { return one.second.contains(destination); });
  if (server == servers_.end()) return false;
  const auto known = acknowledged_.find({server->first, writer});
  return known != acknowledged_.end() && last >= 1 && last <= known->second;
}

}  // namespace fleetloc
