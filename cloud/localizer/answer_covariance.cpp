#include "cloud/localizer/answer_covariance.hpp"

#include "cloud/localizer/weak_directions.hpp"

namespace fleetloc {

std::optional<AnswerCovariance> answer_covariance(const WindowProblem& problem,
                                                  const WindowSystem& system,
                                                  const MapConstraint& constraint,
                                                  const PosePrior& prior,
                                                  const Matrix6d& rivals) {
  const std::optional<Matrix6d> marginal = system.covariance_of_newest();
  if (!marginal) return std::nullopt;
  PoseWithCovariance newest{system.T_map_body.back(), *marginal};
  const Pose step = inverse(problem.pose(prior.keyframe)) * newest.T_map_body;
  const Matrix6d A = adjoint(inverse(step));
  double weak_sigma_m = 0.0;
  if (constraint.weak.cols() > 0) {
    const auto growth = problem.covariance_from(prior.keyframe, system.keyframes.back());
    if (!growth) return std::nullopt;
    const Matrix6d carried = A * prior.estimate.covariance * A.transpose() + *growth;
    newest.covariance = widened_along(constraint, newest, carried);
    weak_sigma_m = weak_sigma(constraint, newest);
  }
  return AnswerCovariance{newest.covariance + A * rivals * A.transpose(), weak_sigma_m};
}

}  // namespace fleetloc
