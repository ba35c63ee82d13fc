#include "robot/fusion/rival_alignments.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace fleetloc {
namespace {

// Scattered wrong answers each found a rival; more than these are not kept.
constexpr std::size_t kMostRivals = 4;

}  // namespace

void Evidence::add(const AnswerMeasurement& answer, double window_s) {
  const auto source =
      std::find_if(sources_.begin(), sources_.end(), [&answer](const Source& candidate) {
        return candidate.localizer == answer.localizer && candidate.epoch == answer.epoch;
      });
  if (source == sources_.end()) {
    sources_.push_back({answer.localizer, answer.epoch, answer.stamp});
    ++independent_;
  } else if (to_seconds(answer.stamp - source->counted) > window_s) {
    source->counted = answer.stamp;
    ++independent_;
  }
}

RivalAlignments::RivalAlignments(const Config& config) : config_(config) {}

void RivalAlignments::drift(const Matrix6d& covariance) {
  for (Rival& rival : rivals_) {
    rival.covariance += covariance;
  }
}

bool RivalAlignments::agrees(const Rival& rival, const AnswerMeasurement& answer) const {
  const Matrix6d& J = answer.J_alignment;
  const Vector6d error =
      local_coordinates(rival.T_map_odom * answer.T_odom_body, answer.T_map_body);
  const Matrix6d S = J * rival.covariance * J.transpose() + answer.covariance;
  return chi_square(error, S) <= config_.gate_chi_square;
}

bool RivalAlignments::contradicts(const Rival& rival) const {
  return rival.agreeing >= config_.lost_after;
}

void RivalAlignments::restart(const AnswerMeasurement& answer) {
  held_ = rivals_.empty() ? Evidence() : std::move(rivals_.back().evidence);
  held_.add(answer, config_.window_s);
  rivals_.clear();
}

void RivalAlignments::support(const AnswerMeasurement& applied) {
  held_.add(applied, config_.window_s);
  for (Rival& rival : rivals_) {
    ++rival.applied_since;
  }
  std::erase_if(rivals_,
                [this](const Rival& rival) { return rival.applied_since >= config_.lost_after; });
}

bool RivalAlignments::add(const AnswerMeasurement& rejected) {
  const auto rival = std::find_if(rivals_.begin(), rivals_.end(), [&](const Rival& candidate) {
    return agrees(candidate, rejected);
  });
  if (rival == rivals_.end()) {
    if (rivals_.size() == kMostRivals) {
      rivals_.erase(rivals_.begin());
    }
    rivals_.emplace_back();
  } else {
    std::rotate(rival, rival + 1, rivals_.end());
  }
  Rival& chosen = rivals_.back();
  chosen.T_map_odom = alignment_from(rejected);
  chosen.covariance = alignment_covariance(rejected);
  ++chosen.agreeing;
  chosen.applied_since = 0;
  chosen.evidence.add(rejected, config_.window_s);
  return chosen.evidence.independent() >= std::min(config_.restart_after, held_.independent() + 1);
}

RivalAlignments RivalAlignments::without_rivals() const {
  RivalAlignments result(config_);
  result.held_ = held_;
  return result;
}

bool RivalAlignments::contradict() const {
  return std::any_of(
      rivals_.begin(), rivals_.end(), [this](const Rival& rival) { return contradicts(rival); });
}

StartPose RivalAlignments::hedged(StartPose held) const {
  for (const Rival& rival : rivals_) {
    if (contradicts(rival)) {
      const Vector6d difference = local_coordinates(held.T_map_odom, rival.T_map_odom);
      held.covariance += difference * difference.transpose();
    }
  }
  return held;
}

}  // namespace fleetloc
