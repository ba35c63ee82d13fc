#include "shared/trajectory/trajectory_error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Cholesky>

#include "shared/geometry/so3.hpp"

namespace fleetloc {

Statistics statistics(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  const auto count = static_cast<double>(values.size());
  double sum = 0.0;
  double sum_of_squares = 0.0;
  for (const double value : values) {
    sum += value;
    sum_of_squares += value * value;
  }
  const double mean = sum / count;
  double squared_deviations = 0.0;
  for (const double value : values) squared_deviations += (value - mean) * (value - mean);
  const std::size_t middle = values.size() / 2;
  const bool even = values.size() % 2 == 0;
  return {.median = even ? 0.5 * (values[middle - 1] + values[middle]) : values[middle],
          .mean = mean,
          .rmse = std::sqrt(sum_of_squares / count),
          .std = std::sqrt(squared_deviations / count),
          .max = values.back()};
}

TrajectoryError absolute_trajectory_error(std::span<const PosePair> pairs,
                                          const Pose& T_truth_estimate) {
  std::vector<double> translations_m;
  std::vector<double> rotations_deg;
  for (const PosePair& pair : pairs) {
    const Pose T_truth_body = T_truth_estimate * pair.T_estimate_body;
    translations_m.push_back((T_truth_body.p - pair.T_truth_body.p).norm());
    const Eigen::Vector3d rotation = log_so3(pair.T_truth_body.R.inverse() * T_truth_body.R);
    rotations_deg.push_back(rotation.norm() * 180.0 / std::numbers::pi);
  }
  return {.poses = pairs.size(),
          .translation_m = statistics(std::move(translations_m)),
          .rotation_deg = statistics(std::move(rotations_deg))};
}

std::optional<double> nees_per_degree_of_freedom(const Pose& T_ref_truth,
                                                 const Pose& T_ref_estimate,
                                                 const Matrix6d& covariance) {
  constexpr double kDegreesOfFreedom = 6.0;
  const Eigen::LLT<Matrix6d> cholesky(covariance);
  if (!covariance.allFinite() || cholesky.info() != Eigen::Success) return std::nullopt;
  const Vector6d error = local_coordinates(T_ref_estimate, T_ref_truth);
  return error.dot(cholesky.solve(error)) / kDegreesOfFreedom;
}

}  // namespace fleetloc
