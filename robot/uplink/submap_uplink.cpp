#include "robot/uplink/submap_uplink.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "shared/config/config_reader.hpp"
#include "shared/link/datagrams.hpp"
#include "shared/wire/malformed.hpp"
#include "shared/wire/submap_codec.hpp"

namespace fleetloc {
namespace {

constexpr std::array<std::size_t, 3> kLongEdges{8, 16, 32};  // keyframes
constexpr double kWorstLoss = 0.75;        // beyond, a handover brings no more bytes
constexpr std::size_t kMaxEdgesAlone = 3;  // of keyframes that are not in the sample
constexpr std::size_t kTooLateToHelp = 2;  // keyframes before the end of the cloud's window

std::size_t wire_bytes(const Bytes& payload) {
  std::size_t sum = 0;
  for (const std::size_t bytes : datagram_sizes(payload.size())) sum += bytes;
  return sum;
}

SubmapEncoding encoding_of(const std::string& name) {
  if (name == "compact") return SubmapEncoding::kCompact;
  if (name == "full") return SubmapEncoding::kFull;
  throw ConfigError("encoding: must be compact or full, not " + name);
}

}  // namespace

SubmapUplink::SubmapUplink(RobotId robot, const Config& config)
    : robot_(std::move(robot)),
      config_(config),
      history_(config.keyframes),
      budget_(config.budget) {}

void SubmapUplink::start_session(const RectifiedStereo& stereo) {
  stereo_ = stereo;
  history_.clear();
  record_.clear();
  window_.reset();
  planned_.reset();
  has_unsent_ = false;
}

void SubmapUplink::restart(SessionNumber session, Incarnation incarnation, std::uint32_t used) {
  sender_.restart(session, incarnation, used);
  record_.clear();
  planned_.reset();
  has_unsent_ = !history_.empty();
  grant_handover();
  sent_.reset();
}

// The localizer has nothing of what is remembered here.
void SubmapUplink::grant_handover() {
  const auto bytes = static_cast<double>(config_.handover_datagrams * config_.max_payload_bytes);
  budget_.grant(static_cast<std::size_t>(bytes / (1.0 - std::min(loss_, kWorstLoss))));
}

// After an outage that was longer than the cloud's window, a localizer begins like a new one.
bool SubmapUplink::has_lost_touch(Timestamp now) const {
  const auto& all = history_.keyframes();
  if (!acknowledged_ || all.size() < config_.keyframes) return false;
  return now - *acknowledged_ > all.back().stamp - all.front().stamp;
}

void SubmapUplink::forget_deliveries() {
  record_.clear();
  planned_.reset();
}

void SubmapUplink::add(Submap window) {
  if (config_.encoding == SubmapEncoding::kFull) {
    window_ = std::move(window);
    return;
  }
  history_.add(window);
  record_.forget_before(history_.keyframes().front().id);
  planned_.reset();
  has_unsent_ = true;
}

void SubmapUplink::acknowledge(const LocalizationResult& answer, Timestamp now) {
  const auto network_delay = sender_.acknowledge(answer, now);
  if (sender_.is_of_stream(answer)) record_.acknowledged(answer.acknowledgements);
  if (network_delay) budget_.measured(*network_delay, now);
  if (has_lost_touch(now)) grant_handover();
  acknowledged_ = now;
}

// The newest window alone: an older one is worth less.
std::optional<Message> SubmapUplink::next_window(Timestamp now) {
  auto window = std::exchange(window_, std::nullopt);
  if (!window) return std::nullopt;
  window->robot = robot_;
  sender_.prepare(*window, now);
  return Message{Topic::kSubmap, encode(*window)};
}

std::optional<Message> SubmapUplink::next(const AnswerReceipt& receipt, Timestamp now) {
  if (config_.encoding == SubmapEncoding::kFull) return next_window(now);
  try {
    return next_sample(receipt, now);
  } catch (const NotEncodable&) {
    history_.clear();
    planned_.reset();
    throw;
  }
}

std::optional<Message> SubmapUplink::next_sample(const AnswerReceipt& receipt, Timestamp now) {
  loss_ = sender_.expected_loss(now);
  budget_.advance(now, loss_);
  const double pause_s = budget_.has_grant() ? config_.handover_pause_s : config_.min_pause_s;
  if (history_.empty() || (sent_ && to_seconds(now - *sent_) < pause_s)) return std::nullopt;
  std::optional<Plan> plan;
  if (has_unsent_) {
    if (!planned_) planned_ = plan_newest();
    if (!planned_ || !budget_.allows(planned_->wire_bytes)) return std::nullopt;
    plan = std::exchange(planned_, std::nullopt);
    has_unsent_ = false;
    last_bytes_ = plan->wire_bytes;
  } else if (budget_.allows(last_bytes_)) {
    sent_ = now;  // not planned anew with each IMU sample
    plan = plan_missing();
    if (!plan || !budget_.allows(plan->wire_bytes)) return std::nullopt;
  }
  if (!plan) return std::nullopt;
  sent_ = now;
  return Message{Topic::kCompactSubmap, encoded(*plan, receipt, now)};
}

Bytes SubmapUplink::encoded(Plan& plan, const AnswerReceipt& receipt, Timestamp now) {
  sender_.prepare(plan.submap, now);
  record_.sent(plan.submap.number, plan.submap, plan.precision.subset);
  budget_.spend(plan.wire_bytes);
  return encode_compact(plan.submap, receipt, plan.precision, stereo_);
}

// The newest keyframe, and before it those that the cloud probably lacks.
std::optional<SubmapUplink::Plan> SubmapUplink::plan_newest() const {
  std::vector<KeyframeId> keyframes;
  const auto& all = history_.keyframes();
  const auto window = std::min(all.size(), config_.window);
  for (std::size_t i = all.size() - window; i < all.size(); ++i) {
    const bool is_newest = i + 1 == all.size();
    if (is_newest || record_.missing(all[i], loss_) > config_.min_missing) {
      keyframes.push_back(all[i].id);
    }
  }
  return fitted(keyframes, keyframes.size() - 1, true);
}

// Around the keyframe that is most probably missing, those next to it: always the one that misses
// more. One that an earlier sample has brought already comes after those that no sample has.
std::optional<SubmapUplink::Plan> SubmapUplink::plan_missing() const {
  const auto seed = most_missing();
  if (!seed) return std::nullopt;
  const auto& all = history_.keyframes();
  const auto wanted = [&](auto keyframe) -> std::optional<double> {
    const double missing = record_.missing(*keyframe, loss_);
    return missing > config_.min_missing ? std::optional(missing) : std::nullopt;
  };
  const auto at = std::ranges::lower_bound(all, *seed, {}, &SubmapKeyframe::id);
  auto first = at;
  auto last = std::next(at);
  while (last - first < static_cast<std::ptrdiff_t>(config_.window)) {
    const auto older = first == all.begin() ? std::nullopt : wanted(std::prev(first));
    const auto newer = last == all.end() ? std::nullopt : wanted(last);
    if (!older && !newer) break;
    if (newer >= older) {
      ++last;
    } else {
      --first;
    }
  }
  std::vector<KeyframeId> keyframes;
  const auto needed = static_cast<std::size_t>(at - first);
  for (; first != last; ++first) keyframes.push_back(first->id);
  return fitted(keyframes, needed, false);
}

std::optional<KeyframeId> SubmapUplink::most_missing() const {
  double most = config_.min_missing_alone;
  std::optional<KeyframeId> found;
  for (const SubmapKeyframe& keyframe : history_.keyframes()) {
    const std::size_t age = history_.newer_than(keyframe.id);
    if (age + kTooLateToHelp >= config_.keyframes) continue;
    const double missing = record_.missing(keyframe, loss_);
    if (missing < most) continue;
    most = missing;
    found = keyframe.id;
  }
  return found;
}

std::vector<EdgeKey> SubmapUplink::edges_for(std::span<const KeyframeId> keyframes,
                                             bool with_newest) const {
  std::vector<EdgeKey> edges;
  std::size_t alone = 0;
  for (const SubmapKeyframe& keyframe : history_.keyframes()) {
    const VirtualEdge* edge = history_.edge_into(keyframe.id);
    if (edge == nullptr || !(record_.missing(*edge, loss_) > config_.min_missing_edge)) continue;
    const bool is_inside = std::ranges::find(keyframes, edge->to) != keyframes.end();
    if (!is_inside && (!with_newest || ++alone > kMaxEdgesAlone)) continue;
    edges.push_back({edge->to, edge->from});
  }
  if (loss_ < config_.risky_loss) return edges;
  const auto& all = history_.keyframes();
  const auto end = std::ranges::lower_bound(all, keyframes.back(), {}, &SubmapKeyframe::id);
  const auto newest = static_cast<std::size_t>(end - all.begin());
  for (const std::size_t span : kLongEdges) {
    if (newest >= span) edges.push_back({all[newest].id, all[newest - span].id});
  }
  return edges;
}

// All of them, if one datagram holds them and the budget brings one for each keyframe. Else every
// second observation, which one tells the sample's number, of as many of the newest as fit.
std::optional<SubmapUplink::Plan> SubmapUplink::fitted(const std::vector<KeyframeId>& keyframes,
                                                       std::size_t needed,
                                                       bool with_newest) const {
  std::size_t bytes = 0;
  Plan all = plan(keyframes, with_newest, {.subset = {}, .step_bits = config_.step_bits}, bytes);
  const bool is_affordable =
      static_cast<double>(all.wire_bytes) <= budget_.bytes_per_s() * keyframe_interval_s();
  if (bytes <= config_.max_payload_bytes && is_affordable) return all;

  const CompactPrecision thinned{.subset = {.stride = 2, .offset = sender_.sent() % 2},
                                 .step_bits = config_.thinned_step_bits};
  std::optional<Plan> best;
  std::size_t fits = 0;
  std::size_t too_many = keyframes.size() + 1;
  while (fits + 1 < too_many) {
    const std::size_t count = fits == 0 ? too_many - 1 : (fits + too_many) / 2;
    const std::size_t begin = std::min(needed, keyframes.size() - count);
    Plan some = plan(std::span(keyframes).subspan(begin, count), with_newest, thinned, bytes);
    if (bytes <= config_.max_payload_bytes) {
      fits = count;
      best = std::move(some);
    } else {
      too_many = count;
    }
  }
  return best;
}

SubmapUplink::Plan SubmapUplink::plan(std::span<const KeyframeId> keyframes,
                                      bool with_newest,
                                      const CompactPrecision& precision,
                                      std::size_t& payload_bytes) const {
  Plan plan{.submap = history_.submap(keyframes, edges_for(keyframes, with_newest)),
            .precision = precision};
  plan.submap.robot = robot_;
  const Bytes payload = encode_compact(plan.submap, {}, precision, stereo_);
  payload_bytes = payload.size();
  plan.wire_bytes = wire_bytes(payload);
  return plan;
}

double SubmapUplink::keyframe_interval_s() const {
  const auto& all = history_.keyframes();
  if (all.size() < 2) return 0.5;
  const std::size_t span = std::min(all.size() - 1, config_.window);
  return to_seconds(all.back().stamp - all[all.size() - 1 - span].stamp) /
         static_cast<double>(span);
}

SubmapUplink::Config read_submap_uplink_config(ConfigReader config) {
  return {
      .encoding = encoding_of(config.get<std::string>("encoding")),
      .keyframes = static_cast<std::size_t>(config.integer("keyframes", 2, 64)),
      .window = static_cast<std::size_t>(config.integer("window", 2, 64)),
      .min_missing = config.positive("min_missing"),
      .min_missing_alone = config.positive("min_missing_alone"),
      .min_missing_edge = config.positive("min_missing_edge"),
      .risky_loss = config.positive("risky_loss"),
      .step_bits = static_cast<std::uint32_t>(config.integer("step_bits", 0, 7)),
      .thinned_step_bits = static_cast<std::uint32_t>(config.integer("thinned_step_bits", 0, 7)),
      .max_payload_bytes =
          static_cast<std::size_t>(config.integer("max_payload_bytes", 400, 60'000)),
      .min_pause_s = config.positive("min_pause_s"),
      .handover_datagrams = static_cast<std::size_t>(config.integer("handover_datagrams", 0, 100)),
      .handover_pause_s = config.positive("handover_pause_s"),
      .budget = read_byte_budget_config(config.section("budget"))};
}

}  // namespace fleetloc
