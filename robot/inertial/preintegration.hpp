#pragma once

#include <span>

#include <Eigen/Core>

#include "shared/core/time.hpp"
#include "shared/model/inertial.hpp"

namespace fleetloc {

using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;
using Matrix96d = Eigen::Matrix<double, 9, 6>;

/// IMU preintegration on the manifold (Forster et al., 2017, eq. 32 to 46), with covariance and
/// bias Jacobians. Order of the nine: [rotation rad, position m, velocity m/s].
class Preintegration {
 public:
  /// Integrates `samples` (increasing stamps, at least two) from the first stamp to the last one
  /// at the given bias. Between samples the mean of both ends is applied (midpoint rule).
  Preintegration(std::span<const ImuSample> samples, const ImuBias& bias, const ImuNoise& noise);

  [[nodiscard]] Duration duration() const;
  [[nodiscard]] const ImuBias& bias() const;  ///< linearization point
  [[nodiscard]] const ImuNoise& noise() const;
  [[nodiscard]] const Matrix9d& covariance() const;  ///< of the deltas
  [[nodiscard]] const Matrix96d& bias_jacobian()
      const;  ///< d deltas / d [gyroscope, accelerometer]

  /// Deltas corrected to first order for another bias.
  struct Deltas {
    Eigen::Quaterniond R;
    Eigen::Vector3d p;
    Eigen::Vector3d v;
  };
  [[nodiscard]] Deltas deltas(const ImuBias& bias) const;

  /// The state at the end, from the state at the start (whose bias is used and kept).
  [[nodiscard]] NavState predict(const NavState& start) const;

  /// Same samples at another linearization point, exactly.
  [[nodiscard]] Preintegration relinearized(const ImuBias& bias) const;
  // private members: the samples, deltas, covariance, Jacobian
};

}  // namespace fleetloc
