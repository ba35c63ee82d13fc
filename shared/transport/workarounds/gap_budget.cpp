#include "shared/transport/workarounds/gap_budget.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

constexpr std::size_t kManyWriters = 4096;  // then the one with most left is forgotten
constexpr std::size_t kInfoSourcePrefixAt = 8;
constexpr double kDay_s = 86'400.0;

double left_after(double left, GapBudget::Clock::duration idle) {
  const double idle_s = std::chrono::duration<double>(idle).count();
  return std::min(left + GapBudget::kNumbers * idle_s / kDay_s, GapBudget::kNumbers);
}

}  // namespace

bool GapBudget::passes(RtpsBytes datagram, Time now) {
  GuidPrefix source = sender_of(datagram);
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind == RtpsKind::kInfoSource) {
      std::ranges::copy(submessage->body.subspan(kInfoSourcePrefixAt, source.size()),
                        source.begin());
    }
    if (submessage->kind != RtpsKind::kGap) continue;
    RtpsFields fields = submessage->fields();
    fields.skip(4);  // reader
    Guid writer{};
    std::ranges::copy(source, writer.begin());
    std::ranges::copy(fields.skip(4), writer.begin() + source.size());
    const std::int64_t first = fields.sequence_number();
    const std::int64_t base = fields.sequence_number();
    const std::uint32_t bits = fields.u32();
    if (!spend(writer, static_cast<double>(base - first) + bits, now)) return false;
  }
  return true;
}

bool GapBudget::spend(const Guid& guid, double numbers, Time now) {
  const std::lock_guard lock(mutex_);
  if (writers_.size() >= kManyWriters && !writers_.contains(guid)) {
    writers_.erase(std::ranges::max_element(writers_, {}, [now](const auto& one) {
      return left_after(one.second.left, now - one.second.seen_at);
    }));
  }
  Writer& writer = writers_.try_emplace(guid, Writer{.seen_at = now}).first->second;
  writer.left = left_after(writer.left, now - writer.seen_at);
  writer.seen_at = now;
  if (numbers > writer.left) return false;
  writer.left -= numbers;
  return true;
}

}  // namespace fleetloc
