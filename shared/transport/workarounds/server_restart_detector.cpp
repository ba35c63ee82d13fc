#include "shared/transport/workarounds/server_restart_detector.hpp"

namespace fleetloc {
namespace {

// Networks change the order of datagrams, but not of those that are so far apart.
constexpr std::chrono::seconds kReordering{1};

}  // namespace

void ServerRestartDetector::watch(const std::set<GuidPrefix>& participants) {
  const std::lock_guard lock(mutex_);
  participants_ = participants;
  latest_.clear();
  is_watching_ = !participants.empty();
  has_restarted_ = false;
}

void ServerRestartDetector::observe(std::span<const std::uint8_t> datagram, Time now) {
  if (!is_watching_) return;
  const GuidPrefix from = sender_of(datagram);
  const std::lock_guard lock(mutex_);
  if (!participants_.contains(from)) return;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind != RtpsKind::kHeartbeat) continue;
    RtpsFields fields = submessage->fields();
    fields.entity();  // reader
    const std::uint32_t writer = fields.entity();
    fields.sequence_number();
    fields.sequence_number();
    const std::uint32_t count = fields.u32();
    Heartbeat& latest = latest_[{from, writer}];
    if (count < latest.count) {
      if (now - latest.at > kReordering) has_restarted_ = true;
    } else {
      latest = {.count = count, .at = now};
    }
  }
}

}  // namespace fleetloc
