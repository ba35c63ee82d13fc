#pragma once

#include <functional>

#include <Eigen/Core>

#include "deploy/sim/motion/quintic_spline.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Exact motion of the body at one instant; the frame `map` is gravity aligned, z up.
struct MotionState {
  Pose T_map_body;
  Eigen::Vector3d v_map = Eigen::Vector3d::Zero();                 ///< [m/s]
  Eigen::Vector3d a_map = Eigen::Vector3d::Zero();                 ///< [m/s^2]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();      ///< in body [rad/s]
  Eigen::Vector3d angular_acceleration = Eigen::Vector3d::Zero();  ///< in body [rad/s^2]
};

/// A motion with analytic derivatives: quintic B-splines of the position and of a quaternion that
/// is normalized afterwards. With q not of unit length and a = q^-1 q',
///   angular velocity = 2 vec(a),  angular acceleration = 2 vec(q^-1 q'' - a a),
/// without the singularities of angles. Four times continuously differentiable.
class SplineMotion {
 public:
  /// Position x y z [m] and quaternion x y z w, one row per coefficient.
  using Coefficients = Eigen::Matrix<double, Eigen::Dynamic, 7>;

  /// Neighbouring quaternions must be of the same sign, so that their interpolation is never near
  /// zero.
  SplineMotion(const SplineGrid& grid, Coefficients coefficients);

  /// The same motion, but for `for_s` from `at_s` on: somebody carries the body over that part, and
  /// no sensor takes notice.
  [[nodiscard]] SplineMotion carried(double at_s, double for_s) const;

  /// @param time_s  from the start; times outside of 0..duration() are moved to its ends
  [[nodiscard]] MotionState at(double time_s) const;
  [[nodiscard]] double duration() const { return grid_.duration_s() - carried_for_s_; }  ///< [s]
  [[nodiscard]] const SplineGrid& grid() const { return grid_; }

 private:
  SplineGrid grid_;
  Coefficients coefficients_;
  double carried_at_s_ = 0.0;
  double carried_for_s_ = 0.0;
};

/// The spline through T_map_body(t), sampled twice per interval of the grid: accurate up to about a
/// fifth of the knots' frequency.
SplineMotion spline_through(const SplineGrid& grid,
                            const std::function<Pose(double time_s)>& T_map_body);

/// The coefficients of R, of the sign that is nearer to those of `last`: x y z w.
Eigen::Vector4d continued_quaternion(const Eigen::Quaterniond& R, const Eigen::Vector4d& last);

/// The same motion after `rest_s` of standstill at its first pose. It then gains speed smoothly
/// (acceleration continuous) within `speed_up_s`, and travels as far meanwhile as in half that
/// time.
SplineMotion with_rest(const SplineMotion& motion, double rest_s, double speed_up_s);

}  // namespace fleetloc
