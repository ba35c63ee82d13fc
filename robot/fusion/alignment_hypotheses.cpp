#include "robot/fusion/alignment_hypotheses.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "shared/geometry/covariance.hpp"

namespace fleetloc {
namespace {

// Each outlier starts a hypothesis; beyond this number the oldest is dropped.
constexpr std::size_t kMaxHypotheses = 4;

// Sigmas of a pose that may be anywhere in a map.
constexpr double kAnywhere_m = 1000.0;
constexpr double kAnywhere_rad = 3.0;

// Three times as uncertain, a ninth of what becomes known was known before.
bool is_decided_by(const LocalizationMeasurement& answer, const Matrix6d& before) {
  constexpr double kUncertain_m = 0.1;
  constexpr double kTimes = 3.0;
  const double sigma_m = max_sigma(before.bottomRightCorner<3, 3>());
  return sigma_m > kUncertain_m &&
         sigma_m > kTimes * max_sigma(answer.covariance.bottomRightCorner<3, 3>());
}

}  // namespace

void HypothesisSupport::add(const LocalizationMeasurement& answer) {
  oldest_stamp_ = std::min(oldest_stamp_.value_or(answer.oldest_stamp), answer.oldest_stamp);
  const auto source =
      std::find_if(sources_.begin(), sources_.end(), [&answer](const Source& candidate) {
        return candidate.localizer == answer.localizer &&
               candidate.incarnation == answer.incarnation;
      });
  if (source == sources_.end()) {
    sources_.push_back({answer.localizer, answer.incarnation, answer.stamp});
    ++independent_;
  } else if (answer.oldest_stamp > source->counted) {
    source->counted = answer.stamp;
    ++independent_;
  }
}

bool HypothesisSupport::is_within_window(const LocalizationMeasurement& answer) const {
  return oldest_stamp_ && reaches_back_to(*oldest_stamp_, answer);
}

AlignmentHypotheses::AlignmentHypotheses(const Config& config) : config_(config) {}

void AlignmentHypotheses::drift(const Matrix6d& covariance) {
  for (Hypothesis& hypothesis : hypotheses_) {
    hypothesis.covariance += covariance;
  }
}

bool AlignmentHypotheses::agrees(const Hypothesis& hypothesis,
                                 const LocalizationMeasurement& answer) const {
  const Matrix6d& J = answer.J_alignment;
  const Vector6d error =
      local_coordinates(hypothesis.T_map_odom * answer.T_odom_body, answer.T_map_body);
  const Matrix6d S = J * hypothesis.covariance * J.transpose() + answer.covariance;
  return chi_square(error, S) <= config_.gate_chi_square;
}

bool AlignmentHypotheses::contradicts(const Hypothesis& hypothesis) const {
  return hypothesis.agreeing >= config_.lost_after;
}

void AlignmentHypotheses::restart(const LocalizationMeasurement& answer) {
  current_support_ =
      hypotheses_.empty() ? HypothesisSupport() : std::move(hypotheses_.back().support);
  current_support_.add(answer);
  hypotheses_.clear();
  is_lost_ = false;
}

void AlignmentHypotheses::lose() {
  current_support_ = HypothesisSupport();
  is_lost_ = true;
}

void AlignmentHypotheses::support(const LocalizationMeasurement& applied, const Matrix6d& before) {
  if (is_decided_by(applied, before)) current_support_ = HypothesisSupport();
  current_support_.add(applied);
  is_lost_ = false;
  for (Hypothesis& hypothesis : hypotheses_) {
    ++hypothesis.applied_since;
  }
  std::erase_if(hypotheses_, [this](const Hypothesis& hypothesis) {
    return hypothesis.applied_since >= config_.lost_after;
  });
}

bool AlignmentHypotheses::add(const LocalizationMeasurement& rejected) {
  const auto hypothesis =
      std::find_if(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& candidate) {
        return agrees(candidate, rejected);
      });
  if (hypothesis == hypotheses_.end()) {
    if (hypotheses_.size() == kMaxHypotheses) {
      hypotheses_.erase(hypotheses_.begin());
    }
    hypotheses_.emplace_back();
  } else {
    std::rotate(hypothesis, hypothesis + 1, hypotheses_.end());
  }
  Hypothesis& chosen = hypotheses_.back();
  chosen.T_map_odom = alignment_from(rejected);
  chosen.covariance = alignment_covariance(rejected);
  ++chosen.agreeing;
  chosen.applied_since = 0;
  chosen.support.add(rejected);
  // As after a session's first answers, which saw little: the localizer has the same keyframes and
  // more, and no longer finds that place.
  if (contradicts(chosen) && current_support_.is_within_window(rejected)) return true;
  return chosen.support.independent() >=
         std::min(config_.restart_after, current_support_.independent() + 1);
}

AlignmentHypotheses AlignmentHypotheses::without_alternatives() const {
  AlignmentHypotheses result(config_);
  result.current_support_ = current_support_;
  result.is_lost_ = is_lost_;
  return result;
}

bool AlignmentHypotheses::contradict() const {
  return is_lost_ ||
         std::any_of(hypotheses_.begin(), hypotheses_.end(), [this](const Hypothesis& hypothesis) {
           return contradicts(hypothesis);
         });
}

MapOdomEstimate AlignmentHypotheses::inflated(MapOdomEstimate estimate) const {
  for (const Hypothesis& hypothesis : hypotheses_) {
    if (contradicts(hypothesis)) {
      const Vector6d difference = local_coordinates(estimate.T_map_odom, hypothesis.T_map_odom);
      estimate.covariance += difference * difference.transpose();
    }
  }
  if (is_lost_) estimate.covariance += diagonal_covariance(kAnywhere_rad, kAnywhere_m);
  return estimate;
}

}  // namespace fleetloc
