#include "robot/fusion/rival_alignments.hpp"

#include <algorithm>
#include <cstddef>

namespace fleetloc {
namespace {

// Scattered wrong answers each found a rival; more than these are not kept.
constexpr std::size_t kMostRivals = 4;

}  // namespace

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

bool RivalAlignments::is_independent(Rival& rival, const AnswerMeasurement& answer) const {
  const auto source =
      std::find_if(rival.sources.begin(), rival.sources.end(), [&answer](const Source& candidate) {
        return candidate.localizer == answer.localizer && candidate.epoch == answer.epoch;
      });
  if (source == rival.sources.end()) {
    rival.sources.push_back({answer.localizer, answer.epoch, answer.stamp});
    return true;
  }
  if (to_seconds(answer.stamp - source->counted) <= config_.window_s) {
    return false;
  }
  source->counted = answer.stamp;
  return true;
}

bool RivalAlignments::add(const AnswerMeasurement& rejected) {
  auto rival = std::find_if(rivals_.begin(), rivals_.end(), [&](const Rival& candidate) {
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
  chosen.independent += is_independent(chosen, rejected) ? 1 : 0;
  return chosen.independent >= config_.restart_after;
}

bool RivalAlignments::contradict() const {
  return std::any_of(rivals_.begin(), rivals_.end(), [this](const Rival& rival) {
    return rival.agreeing >= config_.lost_after;
  });
}

void RivalAlignments::clear() {
  rivals_.clear();
}

}  // namespace fleetloc
