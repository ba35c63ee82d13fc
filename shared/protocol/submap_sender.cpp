#include "shared/protocol/submap_sender.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxInFlight = 512;  // acknowledgements of older samples give no round trip

}  // namespace

void SubmapSender::restart(SessionNumber session, Incarnation incarnation, std::uint32_t used) {
  SubmapSender fresh;
  fresh.session_ = session;
  fresh.incarnation_ = incarnation;
  fresh.round_trip_ = round_trip_;  // the network is still the same
  // A localizer that this robot comes back to may remember the session and its numbers.
  if (session == session_) fresh.next_number_ = std::max(next_number_, used);
  *this = std::move(fresh);
}

bool SubmapSender::awaits(KeyframeId newest) const {
  return std::ranges::any_of(in_flight_, [&](const auto& item) {
    return item.second.newest == newest && !item.second.is_acknowledged;
  });
}

void SubmapSender::prepare(Submap& submap, Timestamp now) {
  submap.session = session_;
  submap.incarnation = incarnation_;
  submap.number = SampleNumber{next_number_};
  in_flight_[next_number_] = {now, submap.keyframes.back().id};
  ++next_number_;
  if (in_flight_.size() > kMaxInFlight) in_flight_.erase(in_flight_.begin());
}

bool SubmapSender::is_of_sent(const Acknowledgements& acknowledgements) const {
  const int span =
      acknowledgements.bitmap == 0 ? 0 : 64 - std::countl_zero(acknowledgements.bitmap);
  const auto base = static_cast<std::uint64_t>(acknowledgements.base);
  return base + static_cast<std::uint64_t>(span) <= next_number_;
}

std::optional<Duration> SubmapSender::acknowledge(const LocalizationResult& answer, Timestamp now) {
  if (!is_of_stream(answer)) return std::nullopt;
  const auto base = static_cast<std::uint32_t>(answer.acknowledgements.base);
  if (base > acknowledged_base_) {
    const std::uint32_t shift = base - acknowledged_base_;
    acknowledged_bitmap_ = shift < 64 ? acknowledged_bitmap_ >> shift : 0;
    acknowledged_base_ = base;
  }
  if (base == acknowledged_base_) acknowledged_bitmap_ |= answer.acknowledgements.bitmap;
  if (answer.acknowledgements.bitmap == 0) return std::nullopt;

  const int span = 64 - std::countl_zero(answer.acknowledgements.bitmap);
  const auto sent = in_flight_.find(base + static_cast<std::uint32_t>(span) - 1);
  if (sent == in_flight_.end()) return std::nullopt;
  const Duration elapsed = now - sent->second.at;
  if (!std::exchange(sent->second.is_acknowledged, true)) round_trip_ = elapsed;
  in_flight_.erase(in_flight_.begin(), sent);
  return std::max(Duration{}, elapsed - answer.holding_time);
}

double SubmapSender::expected_loss(Timestamp now) const {
  constexpr double kUnknownLoss = 0.7;  // to rely on nothing before the first acknowledgement
  if (acknowledged_bitmap_ == 0) return kUnknownLoss;
  constexpr double kPriorLoss = 0.25;
  constexpr double kPriorSamples = 2.0;
  constexpr double kPatienceSeconds =
      2.0;  // acknowledgements come with answers, which get lost, too
  constexpr double kPatienceRoundTrips = 2.0;
  const int span = acknowledged_bitmap_ == 0 ? 0 : 64 - std::countl_zero(acknowledged_bitmap_);
  const std::uint32_t known = acknowledged_base_ + static_cast<std::uint32_t>(span);
  const Duration patience = from_seconds(
      kPatienceSeconds + kPatienceRoundTrips * to_seconds(round_trip_.value_or(Duration{})));
  const auto overdue = static_cast<double>(std::ranges::count_if(in_flight_, [&](const auto& item) {
    return item.first >= known && item.second.at + patience < now;
  }));
  return (span * loss() + overdue + kPriorSamples * kPriorLoss) / (span + overdue + kPriorSamples);
}

// Samples after the last acknowledged one may still be on their way, so they do not count.
double SubmapSender::loss() const {
  if (acknowledged_bitmap_ == 0) return 0.0;
  const int span = 64 - std::countl_zero(acknowledged_bitmap_);
  const int arrived = std::popcount(acknowledged_bitmap_);
  return static_cast<double>(span - arrived) / span;
}

}  // namespace fleetloc
