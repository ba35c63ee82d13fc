#include "cloud/localizer/answer_covariance.hpp"

#include "cloud/localizer/weak_directions.hpp"

namespace fleetloc {

std::optional<AnswerCovariance> answer_covariance(const WindowProblem& problem,
                                                  const WindowSystem& system,
                                                  const MapConstraint& constraint,
                                                  const PosePrior& prior) {
  const std::optional<Matrix6d> marginal = system.covariance_of_newest();
  if (!marginal) return std::nullopt;
  if (constraint.weak.cols() == 0) return AnswerCovariance{*marginal, 0.0};
  const auto growth = problem.covariance_from(prior.keyframe, system.keyframes.back());
  if (!growth) return std::nullopt;
  PoseWithCovariance newest{system.T_map_body.back(), *marginal};
  const Pose step = inverse(problem.pose(prior.keyframe)) * newest.T_map_body;
  const Matrix6d A = adjoint(inverse(step));
  const Matrix6d carried = A * prior.estimate.covariance * A.transpose() + *growth;
  newest.covariance = widened_along(constraint, newest, carried);
  return AnswerCovariance{newest.covariance, weak_sigma(constraint, newest)};
}

}  // namespace fleetloc
