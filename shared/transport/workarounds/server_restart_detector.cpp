#include "shared/transport/workarounds/server_restart_detector.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

// Networks change the order of datagrams, but not of those that are so far apart.
constexpr std::chrono::seconds kReordering{1};

}  // namespace

void ServerRestartDetector::watch(const std::set<GuidPrefix>& participants) {
  participants_ = participants;
  latest_.clear();
  has_restarted_ = false;
}

void ServerRestartDetector::observe(std::span<const std::uint8_t> datagram, Time now) {
  if (participants_.empty()) return;
  GuidPrefix from{};
  std::ranges::copy(datagram.subspan(kGuidPrefixAt, from.size()), from.begin());
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
      has_restarted_ = has_restarted_ || now - latest.at > kReordering;
    } else {
      latest = {.count = count, .at = now};
    }
  }
}

}  // namespace fleetloc
