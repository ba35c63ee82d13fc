#include "cloud/localizer/answer_covariance.hpp"

#include "cloud/localizer/weak_directions.hpp"

namespace fleetloc {
namespace {

// A covariance of the pose of one keyframe, as one of the newest pose that moves rigidly with it.
Matrix6d carried(const Matrix6d& covariance, const Pose& T_map_body, const Pose& T_map_newest) {
  const Matrix6d A = adjoint(inverse(T_map_newest) * T_map_body);
  return A * covariance * A.transpose();
}

}  // namespace

std::optional<AnswerCovariance> answer_covariance(const WindowProblem& problem,
                                                  const WindowSystem& system,
                                                  const MapConstraint& constraint,
                                                  const DegeneracyConfig& config,
                                                  const Prediction& prediction,
                                                  const Matrix6d& other_places) {
  const std::optional<Matrix6d> marginal = system.covariance_of_newest();
  if (!marginal) return std::nullopt;
  PoseWithCovariance newest{system.T_map_body.back(), *marginal};
  const bool is_told_start = prediction.is_start && !prediction.is_found;
  const WeakDirections unknown =
      constraint.weaker_than(is_told_start ? config.start_weak_sigma_m : config.weak_sigma_m);
  if (unknown.cols() > 0) {
    const PosePrior& before = prediction.before;
    const auto growth = problem.covariance_from(before.keyframe, system.keyframes.back());
    if (!growth) return std::nullopt;
    const Matrix6d known =
        carried(before.estimate.covariance, problem.pose(before.keyframe), newest.T_map_body);
    newest.covariance = widened_along(unknown, constraint.motion, newest, known + *growth);
  }
  const WeakDirections weak = constraint.weaker_than(config.weak_sigma_m);
  const double weak_sigma_m = weak_sigma(weak, constraint.motion, newest);
  newest.covariance += other_places;
  return AnswerCovariance{newest.covariance, weak_sigma_m};
}

}  // namespace fleetloc
