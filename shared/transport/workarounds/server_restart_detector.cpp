#include "shared/transport/workarounds/server_restart_detector.hpp"

namespace fleetloc {
namespace {

// Networks change the order of datagrams, but not of those that are so far apart.
constexpr std::chrono::seconds kReordering{1};

std::uint32_t count_in(RtpsFields heartbeat) {
  heartbeat.skip(8);  // reader, writer
  heartbeat.sequence_number();
  heartbeat.sequence_number();
  return heartbeat.u32();
}

void write_number(std::span<std::uint8_t> bytes, bool is_little_endian, std::uint32_t number) {
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::size_t place = is_little_endian ? i : bytes.size() - 1 - i;
    bytes[i] = static_cast<std::uint8_t>(number >> (8 * place));
  }
}

}  // namespace

void ServerRestartDetector::watch(const std::set<GuidPrefix>& participants) {
  const std::lock_guard lock(mutex_);
  participants_ = participants;
  latest_.clear();
  is_watching_ = !participants.empty();
  has_restarted_ = false;
}

std::optional<std::vector<std::uint8_t>> ServerRestartDetector::observe(
    std::span<const std::uint8_t> datagram, Time now) {
  constexpr std::size_t kCountAt = 24;  // behind reader, writer and two sequence numbers
  if (!is_watching_) return std::nullopt;
  const GuidPrefix from = sender_of(datagram);
  const std::lock_guard lock(mutex_);
  if (!participants_.contains(from)) return std::nullopt;
  std::optional<std::vector<std::uint8_t>> changed;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind != RtpsKind::kHeartbeat) continue;
    const std::uint32_t raise = observe(from, submessage->fields(), now);
    if (raise == 0) continue;
    if (!changed) changed.emplace(datagram.begin(), datagram.end());
    const auto body = static_cast<std::size_t>(submessage->body.data() - datagram.data());
    write_number(std::span(*changed).subspan(body + kCountAt, 4),
                 (submessage->flags & kLittleEndian) != 0,
                 count_in(submessage->fields()) + raise);
  }
  return changed;
}

std::uint32_t ServerRestartDetector::observe(const GuidPrefix& from,
                                             RtpsFields heartbeat,
                                             Time now) {
  const std::uint32_t count = count_in(heartbeat);
  heartbeat.entity();  // reader
  const std::uint32_t writer = heartbeat.entity();
  heartbeat.sequence_number();
  const std::int64_t last_sample = heartbeat.sequence_number();
  Heartbeat& latest = latest_[{from, writer}];
  if (count < latest.count) {
    if (now - latest.at <= kReordering) return latest.counted_before;
    if (last_sample < latest.last_sample) {
      has_restarted_ = true;
      return latest.counted_before;
    }
    latest.counted_before += latest.count;
  }
  latest.count = count;
  latest.last_sample = last_sample;
  latest.at = now;
  return latest.counted_before;
}

}  // namespace fleetloc
