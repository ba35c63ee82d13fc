#include "robot/cloud_client/localizer_selector.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

constexpr double kFalseAlarms = 0.15;  // share of the pauses that loss alone makes and that count
constexpr double kNoLoss = 0.01;
constexpr double kWorstLoss = 0.9;            // beyond, timeouts do not grow
constexpr double kSuccessorTimeouts = 2.0;    // it has to be told of the session first
constexpr double kRefusedAfterSeconds = 0.5;  // it may have become full by this robot
constexpr double kPatienceSeconds = 15.0;     // with a successor that finds no pose, without need
constexpr int kFewerRobots = 2;
constexpr double kFewerRobotsFactor = 1.25;
constexpr double kNoLighterLoad = 0.05;  // a localizer with that much more is no better place

}  // namespace

LocalizerSelector::LocalizerSelector(std::string_view robot, const Config& config)
    : robot_(robot), config_(config), known_(robot, config.known) {}

void LocalizerSelector::sent(Timestamp now) {
  if (!waiting_since_) waiting_since_ = now;
}

void LocalizerSelector::answered(Timestamp now) {
  has_answered_ = true;
  warning_.clear();
  waiting_since_.reset();
  last_activity_ = now;
  consecutive_timeouts_ = 0;
  known_.answered(name_);
}

void LocalizerSelector::take_over(Timestamp now) {
  const Successor successor = *std::exchange(successor_, std::nullopt);
  if (successor.is_urgent) known_.exclude(name_, now);
  choose(successor.name, successor.incarnation, successor.reason, now);
}

LocalizerSelector::Change LocalizerSelector::decide(Timestamp now, const Link& link) {
  other_map_ = known_.with_other_map(now);
  if (name_.empty()) return choose_first(now);
  const Localizer& current = known_.at(name_);
  if (!accepts_map(current.status.map_hash)) return leave_map(now);
  if (current.status.incarnation != incarnation_) return follow_restart(current, now);
  if (successor_) return follow_successor(now, link);
  const Fault fault = fault_of(current, now, link);
  return fault == Fault::kNone ? balance(current, now) : leave(fault, now);
}

LocalizerSelector::Change LocalizerSelector::choose_first(Timestamp now) {
  for (const Range range : {Range::kFit, Range::kExcluded}) {
    const Localizer* candidate = known_.best({}, now, range);
    if (candidate == nullptr) continue;
    choose(candidate->status.localizer, candidate->status.incarnation, "available", now);
    return Change::kChosen;
  }
  return Change::kNone;
}

// What it answers would not fit the poses that the robot has.
LocalizerSelector::Change LocalizerSelector::leave_map(Timestamp now) {
  const std::string why = "has another map now";
  if (const Localizer* other = known_.best({name_}, now)) {
    choose(other->status.localizer, other->status.incarnation, name_ + " " + why, now);
    return Change::kChosen;
  }
  reason_ = "it " + why;
  name_.clear();
  successor_.reset();
  warning_.clear();
  waiting_since_.reset();
  return Change::kLeft;
}

// A successor has begun already.
LocalizerSelector::Change LocalizerSelector::follow_restart(const Localizer& current,
                                                            Timestamp now) {
  if (successor_) {
    choose(successor_->name, successor_->incarnation, name_ + " was restarted", now);
    return Change::kChosen;
  }
  choose(name_, current.status.incarnation, "it was restarted", now);
  return Change::kRestarted;
}

LocalizerSelector::Fault LocalizerSelector::fault_of(const Localizer& current,
                                                     Timestamp now,
                                                     const Link& link) const {
  if (!known_.is_alive(current, now) &&
      to_seconds(now - last_activity_) > config_.known.status_timeout_s) {
    return Fault::kGone;
  }
  if (waiting_since_ && is_late(*waiting_since_, now, link, 1.0)) return Fault::kSilent;
  if (current.status.draining) return Fault::kDraining;
  if (!current.status.accepting && !has_answered_ &&
      to_seconds(now - last_activity_) > kRefusedAfterSeconds) {
    return Fault::kRefuses;
  }
  return Fault::kNone;
}

LocalizerSelector::Change LocalizerSelector::leave(Fault fault, Timestamp now) {
  const Localizer* other = known_.best({name_}, now);
  const bool is_dead = fault == Fault::kGone || fault == Fault::kSilent;
  if (other == nullptr && is_dead) other = known_.best({name_}, now, Range::kFull);
  if (other == nullptr && fault == Fault::kGone) {
    other = known_.best({name_}, now, Range::kExcluded);
  }
  const char* what = fault == Fault::kDraining ? " is about to end"
                     : fault == Fault::kGone   ? " is gone"
                     : fault == Fault::kSilent ? " does not answer"
                                               : " accepts no more robots";
  warning_ = other == nullptr ? name_ + what : "";
  if (other == nullptr) return Change::kNone;
  return begin(*other, name_ + what, fault != Fault::kDraining, now);
}

LocalizerSelector::Change LocalizerSelector::follow_successor(Timestamp now, const Link& link) {
  const Localizer& next = known_.at(successor_->name);
  const Fault fault = fault_of(known_.at(name_), now, link);
  const bool is_silent = fault == Fault::kSilent || fault == Fault::kGone;
  if (successor_->is_urgent && fault == Fault::kNone) return stay();
  if (successor_->answered && is_silent) {
    take_over(now);
    return Change::kChosen;
  }
  const bool is_lost = next.status.draining || !known_.is_alive(next, now) ||
                       !accepts_map(next.status.map_hash) ||
                       next.status.incarnation != successor_->incarnation;
  const Timestamp heard = successor_->answered.value_or(successor_->since);
  const bool is_useless =
      fault == Fault::kNone && to_seconds(now - successor_->since) > kPatienceSeconds;
  if (!is_lost && !is_useless && !is_late(heard, now, link, kSuccessorTimeouts)) {
    return Change::kNone;
  }
  return replace_successor(fault, is_lost, now);
}

// If both are silent, the link may be: the one that was tried last is waited for, ever longer.
LocalizerSelector::Change LocalizerSelector::replace_successor(Fault fault,
                                                               bool is_lost,
                                                               Timestamp now) {
  const std::string failed = successor_->name;
  ++consecutive_timeouts_;
  known_.exclude(failed, now);
  if (fault == Fault::kNone) return stay();
  const Localizer* other = known_.best({name_, failed}, now);
  if (other != nullptr) {
    return begin(*other, failed + " does not answer", fault != Fault::kDraining, now);
  }
  if (is_lost || fault == Fault::kDraining) return stay();
  take_over(now);
  return Change::kChosen;
}

LocalizerSelector::Change LocalizerSelector::balance(const Localizer& current, Timestamp now) {
  const Localizer* other = known_.best({name_}, now);
  if (other == nullptr || !has_answered_) {
    overloaded_since_.reset();
    crowded_since_.reset();
    return Change::kNone;
  }
  const bool is_overloaded = is_overloaded_for_long(current, *other, now);
  const bool is_crowded = is_crowded_for_long(current, *other, now);
  if (!is_overloaded && !is_crowded) return Change::kNone;
  ++moves_;
  return begin(*other, name_ + (is_overloaded ? " is overloaded" : " has more robots"), false, now);
}

// Without loss one interval; with loss as many as it takes for an answer to most probably come.
bool LocalizerSelector::is_late(Timestamp since,
                                Timestamp now,
                                const Link& link,
                                double factor) const {
  const double round_trip_s =
      link.round_trip ? to_seconds(*link.round_trip) : config_.first_round_trip_s;
  const double loss = std::clamp(link.loss, kNoLoss, kWorstLoss);
  const double pause_s = config_.sample_interval_s * std::log(kFalseAlarms) / std::log(loss);
  const double in_time_s = factor * (std::max(config_.answer_timeout_s, pause_s) +
                                     config_.timeout_round_trips * round_trip_s);
  const double doubled_s = std::ldexp(in_time_s, std::min(consecutive_timeouts_, kMaxDoublings));
  return to_seconds(now - since) > std::min(doubled_s, std::max(in_time_s, config_.max_timeout_s));
}

bool LocalizerSelector::is_overloaded_for_long(const Localizer& current,
                                               const Localizer& other,
                                               Timestamp now) {
  const bool would_gain = current.status.load >= config_.overload &&
                          current.status.load - other.status.load >= config_.min_load_gain;
  if (!would_gain) {
    overloaded_since_.reset();
    return false;
  }
  if (!overloaded_since_) overloaded_since_ = now;
  const double patience_s = config_.load_patience_s * (1.0 + patience("load"));
  return to_seconds(now - *overloaded_since_) > patience_s;
}

// So many more than on the other one that the difference is still there after the move.
bool LocalizerSelector::is_crowded_for_long(const Localizer& current,
                                            const Localizer& other,
                                            Timestamp now) {
  const int here = current.status.sessions;
  const int there = other.status.sessions;
  const bool would_gain = here - there >= kFewerRobots && here > kFewerRobotsFactor * (there + 1) &&
                          other.status.load <= current.status.load + kNoLighterLoad;
  if (!would_gain) {
    crowded_since_.reset();
    return false;
  }
  if (!crowded_since_) crowded_since_ = now;
  const double patience_s = config_.crowd_patience_s * (1.0 + 2.0 * patience("crowd"));
  return to_seconds(now - *crowded_since_) > patience_s;
}

// Of this robot, 0..1, another one for each move.
double LocalizerSelector::patience(std::string_view of) const {
  const std::string what = std::string(of) + std::to_string(moves_);
  return static_cast<double>(rendezvous_hash(robot_, what) % 1000) / 1000.0;
}

LocalizerSelector::Change LocalizerSelector::begin(const Localizer& successor,
                                                   std::string reason,
                                                   bool is_urgent,
                                                   Timestamp now) {
  overloaded_since_.reset();
  crowded_since_.reset();
  successor_ = {.name = successor.status.localizer,
                .incarnation = successor.status.incarnation,
                .since = now,
                .reason = std::move(reason),
                .is_urgent = is_urgent,
                .answered = {}};
  reason_ = successor_->reason;
  return Change::kSuccessor;
}

LocalizerSelector::Change LocalizerSelector::stay() {
  successor_.reset();
  return Change::kStays;
}

void LocalizerSelector::choose(const std::string& name,
                               Incarnation incarnation,
                               std::string reason,
                               Timestamp now) {
  reason_ = std::move(reason);
  name_ = name;
  incarnation_ = incarnation;
  successor_.reset();
  warning_.clear();
  has_answered_ = false;
  waiting_since_.reset();
  last_activity_ = now;
  overloaded_since_.reset();
  crowded_since_.reset();
}

LocalizerSelector::Config read_localizer_selector_config(ConfigReader config) {
  return {.answer_timeout_s = config.positive("answer_timeout_s"),
          .timeout_round_trips = config.positive("timeout_round_trips"),
          .first_round_trip_s = config.positive("first_round_trip_s"),
          .sample_interval_s = config.positive("sample_interval_s"),
          .max_timeout_s = config.positive("max_timeout_s"),
          .overload = config.positive("overload"),
          .min_load_gain = config.positive("min_load_gain"),
          .load_patience_s = config.positive("load_patience_s"),
          .crowd_patience_s = config.positive("crowd_patience_s"),
          .known = {.status_timeout_s = config.positive("status_timeout_s"),
                    .exclusion_s = config.positive("exclusion_s"),
                    .max_exclusion_s = config.positive("max_exclusion_s")}};
}

}  // namespace fleetloc
