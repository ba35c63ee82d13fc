#include "deploy/sim/motion/spline_motion.hpp"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

namespace fleetloc {
namespace {

Eigen::Quaterniond quaternion(const Eigen::Vector4d& xyzw) {
  return Eigen::Quaterniond(xyzw);
}

// Time of the original motion: zero at rest, then its rate goes from 0 to 1 as
// u^3 (10 - 15 u + 6 u^2), whose integral is u^4 (2.5 - 3 u + u^2).
double time_in_motion(double time_s, double rest_s, double speed_up_s) {
  const double after_s = time_s - rest_s;
  if (after_s <= 0.0) return 0.0;
  if (after_s >= speed_up_s) return after_s - 0.5 * speed_up_s;
  const double u = after_s / speed_up_s;
  return speed_up_s * u * u * u * u * (2.5 + u * (u - 3.0));
}

}  // namespace

SplineMotion::SplineMotion(const SplineGrid& grid, Coefficients coefficients)
    : grid_(grid), coefficients_(std::move(coefficients)) {
  assert(coefficients_.rows() == grid_.coefficients());
}

SplineMotion SplineMotion::carried(double at_s, double for_s) const {
  SplineMotion result = *this;
  result.carried_at_s_ = at_s;
  result.carried_for_s_ = std::clamp(for_s, 0.0, std::max(0.0, grid_.duration_s() - at_s));
  return result;
}

MotionState SplineMotion::at(double time_s) const {
  const bool is_before = time_s < carried_at_s_;
  const auto [interval, u] = grid_.place(is_before ? time_s : time_s + carried_for_s_);
  Eigen::Matrix<double, 7, 3> jet =
      coefficients_.middleRows<kQuinticSupport>(interval).transpose() * quintic_basis(u);
  jet.col(1) /= grid_.interval_s;
  jet.col(2) /= grid_.interval_s * grid_.interval_s;

  const Eigen::Quaterniond q = quaternion(jet.block<4, 1>(3, 0));
  const Eigen::Quaterniond q_inverse = q.inverse();
  const Eigen::Quaterniond a = q_inverse * quaternion(jet.block<4, 1>(3, 1));
  const Eigen::Quaterniond b = q_inverse * quaternion(jet.block<4, 1>(3, 2));
  return {.T_map_body = {.R = q.normalized(), .p = jet.block<3, 1>(0, 0)},
          .v_map = jet.block<3, 1>(0, 1),
          .a_map = jet.block<3, 1>(0, 2),
          .angular_velocity = 2.0 * a.vec(),
          .angular_acceleration = 2.0 * b.vec() - 4.0 * a.w() * a.vec()};
}

Eigen::Vector4d continued_quaternion(const Eigen::Quaterniond& R, const Eigen::Vector4d& last) {
  return R.coeffs().dot(last) < 0.0 ? Eigen::Vector4d(-R.coeffs()) : Eigen::Vector4d(R.coeffs());
}

SplineMotion spline_through(const SplineGrid& grid,
                            const std::function<Pose(double time_s)>& T_map_body) {
  constexpr int kPerInterval = 2;
  // Only what the samples leave open, at the ends; far below what changes a value.
  constexpr double kPenaltyOfUnitGrid = 1e-12;
  const int count = kPerInterval * grid.intervals + 1;
  SplineSamples samples{.times_s = {},
                        .weights = std::vector<double>(static_cast<std::size_t>(count), 1.0),
                        .values = Eigen::MatrixXd(count, 7)};
  Eigen::Vector4d last = Eigen::Vector4d::Zero();
  for (int i = 0; i < count; ++i) {
    const double time_s = grid.interval_s * i / kPerInterval;
    const Pose pose = T_map_body(time_s);
    last = continued_quaternion(pose.R, last);
    samples.times_s.push_back(time_s);
    samples.values.row(i) << pose.p.transpose(), last.transpose();
  }
  const double penalty = kPenaltyOfUnitGrid * std::pow(grid.interval_s, 5);
  const std::vector<double> penalties(static_cast<std::size_t>(grid.intervals), penalty);
  return {grid, fit_quintic_spline(grid, samples, penalties)};
}

SplineMotion with_rest(const SplineMotion& motion, double rest_s, double speed_up_s) {
  const SplineGrid grid =
      grid_over(motion.duration() + rest_s + 0.5 * speed_up_s, motion.grid().interval_s);
  return spline_through(grid, [&](double time_s) {
    return motion.at(time_in_motion(time_s, rest_s, speed_up_s)).T_map_body;
  });
}

}  // namespace fleetloc
