#include "robot/live/stamp_gate.hpp"

#include <algorithm>
#include <utility>

namespace fleetloc {
namespace {

constexpr Duration kLargestDeviation = std::chrono::seconds(1);
constexpr int kConfirmations = 3;  // stamps in a row

}  // namespace

std::string_view name(StampRefusal reason) {
  switch (reason) {
    case StampRefusal::kZero:
      return "zero_stamp";
    case StampRefusal::kDoubled:
      return "doubled";
    case StampRefusal::kOutOfOrder:
      return "out_of_order";
    case StampRefusal::kUnconfirmed:
      return "unconfirmed";
  }
  return "unknown";
}

expected<AcceptedStamp, StampRefusal> StampGate::check(Timestamp stamp, ArrivalTime arrival) {
  if (stamp <= Timestamp{}) return unexpected(StampRefusal::kZero);
  AcceptedStamp accepted;
  if (newest_) {
    const Duration ahead = stamp - *newest_;
    const Duration elapsed = std::max(arrival - arrival_, Duration{});
    accepted.unseen = elapsed;
    if (ahead == Duration{}) return unexpected(StampRefusal::kDoubled);
    if (ahead < Duration{} && ahead >= -kLargestDeviation) {
      return unexpected(StampRefusal::kOutOfOrder);
    }
    if (ahead < Duration{} || ahead - elapsed > kLargestDeviation) {
      if (!confirms(stamp)) return unexpected(StampRefusal::kUnconfirmed);
      accepted.step = ahead - elapsed;
    }
  }
  newest_ = stamp;
  arrival_ = arrival;
  candidate_.reset();
  return accepted;
}

bool StampGate::confirms(Timestamp stamp) {
  const Duration since = candidate_ ? stamp - candidate_->newest : Duration{};
  const bool goes_on = since > Duration{} && since <= kLargestDeviation;
  candidate_ = Candidate{.newest = stamp, .count = goes_on ? candidate_->count + 1 : 1};
  return candidate_->count >= kConfirmations;
}

void StampGate::forget() {
  newest_.reset();
  candidate_.reset();
}

}  // namespace fleetloc
