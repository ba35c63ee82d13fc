#include "deploy/evaluation/errors/trajectory_error.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Cholesky>

#include "shared/geometry/angle.hpp"
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

namespace {

double angle_deg(const Eigen::Quaterniond& R) {
  return kDegPerRad * log_so3(R).norm();
}

/// The pair nearest to `stamp`; null if none is within `tolerance`.
const PosePair* pair_at(std::span<const PosePair> pairs, Timestamp stamp, Duration tolerance) {
  const auto distance = [stamp](const PosePair& pair) {
    return std::chrono::abs(pair.stamp - stamp);
  };
  auto found = std::ranges::lower_bound(pairs, stamp, {}, &PosePair::stamp);
  const bool before_is_nearer =
      found != pairs.begin() &&
      (found == pairs.end() || distance(*std::prev(found)) < distance(*found));
  if (before_is_nearer) --found;
  return found != pairs.end() && distance(*found) <= tolerance ? &*found : nullptr;
}

}  // namespace

TrajectoryError absolute_trajectory_error(std::span<const PosePair> pairs,
                                          const Pose& T_truth_estimate) {
  std::vector<double> translations_m;
  std::vector<double> rotations_deg;
  for (const PosePair& pair : pairs) {
    const Pose T_truth_body = T_truth_estimate * pair.T_estimate_body;
    translations_m.push_back((T_truth_body.p - pair.T_truth_body.p).norm());
    rotations_deg.push_back(angle_deg(pair.T_truth_body.R.inverse() * T_truth_body.R));
  }
  return {.poses = pairs.size(),
          .translation_m = statistics(std::move(translations_m)),
          .rotation_deg = statistics(std::move(rotations_deg))};
}

TrajectoryError relative_trajectory_error(std::span<const PosePair> pairs,
                                          Duration interval,
                                          Duration tolerance) {
  std::vector<double> translations_m;
  std::vector<double> rotations_deg;
  for (const PosePair& from : pairs) {
    const PosePair* to = pair_at(pairs, from.stamp + interval, tolerance);
    if (to == nullptr || to == &from) continue;
    const Pose moved = inverse(from.T_truth_body) * to->T_truth_body;
    const Pose estimated = inverse(from.T_estimate_body) * to->T_estimate_body;
    const Pose error = inverse(moved) * estimated;
    translations_m.push_back(error.p.norm());
    rotations_deg.push_back(angle_deg(error.R));
  }
  return {.poses = translations_m.size(),
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
