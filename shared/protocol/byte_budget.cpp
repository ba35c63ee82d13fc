#include "shared/protocol/byte_budget.hpp"

#include <algorithm>

#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kRecent = 4;
constexpr double kCutPauseSeconds = 1.0;  // beside the round trip: a cut takes that long to show

}  // namespace

ByteBudget::ByteBudget(const Config& config)
    : config_(config),
      cap_(config.max_bytes_per_s),
      rate_(config.max_bytes_per_s),
      tokens_(config.burst_bytes) {}

void ByteBudget::advance(Timestamp now, double loss) {
  const double elapsed_s = now_ ? to_seconds(now - *now_) : 0.0;
  now_ = now;
  tokens_.advance(now, bytes_per_s());
  cap_ = loss >= config_.high_loss ? config_.max_bytes_per_s_high_loss : config_.max_bytes_per_s;
  if (elapsed_s <= 0.0) return;
  const bool may_grow = is_measured() && to_seconds(queueing_) <= config_.max_queueing_s;
  const double growth = may_grow ? config_.increase_bytes_per_s2 * elapsed_s : 0.0;
  rate_ = std::clamp(rate_ + growth, config_.min_bytes_per_s, cap_);
}

void ByteBudget::measured(Duration round_trip, Timestamp now) {
  recent_.push_back({now, round_trip});
  if (recent_.size() > kRecent) recent_.pop_front();
  while (!shortest_.empty() && shortest_.back().length >= round_trip) shortest_.pop_back();
  shortest_.push_back({now, round_trip});
  while (to_seconds(now - shortest_.front().at) > config_.shortest_memory_s) shortest_.pop_front();

  round_trip_ = std::ranges::min_element(recent_, {}, &RoundTrip::length)->length;
  queueing_ = round_trip_ - shortest_.front().length;
  if (to_seconds(queueing_) <= config_.max_queueing_s || (next_cut_ && now < *next_cut_)) return;
  rate_ = std::max(config_.min_bytes_per_s, config_.decrease * rate_ / stretch());
  next_cut_ = now + round_trip_ + from_seconds(kCutPauseSeconds);
}

// How much longer the latest samples took to arrive than to be sent: a full bottleneck passes that
// much less than it is given.
double ByteBudget::stretch() const {
  const double arriving_s = to_seconds(recent_.back().at - recent_.front().at);
  const double sending_s = arriving_s - to_seconds(recent_.back().length - recent_.front().length);
  return sending_s > 0.0 ? std::clamp(arriving_s / sending_s, 1.0, 10.0) : 1.0;
}

ByteBudget::Config read_byte_budget_config(ConfigReader config) {
  return {.max_bytes_per_s = config.positive("max_bytes_per_s"),
          .max_bytes_per_s_high_loss = config.positive("max_bytes_per_s_high_loss"),
          .high_loss = config.positive("high_loss"),
          .min_bytes_per_s = config.positive("min_bytes_per_s"),
          .burst_bytes = config.positive("burst_bytes"),
          .max_queueing_s = config.positive("max_queueing_s"),
          .increase_bytes_per_s2 = config.positive("increase_bytes_per_s2"),
          .decrease = config.positive("decrease"),
          .shortest_memory_s = config.positive("shortest_memory_s"),
          .unmeasured_bytes_per_s = config.positive("unmeasured_bytes_per_s"),
          .measured_for_s = config.positive("measured_for_s")};
}

}  // namespace fleetloc
