#pragma once

#include <span>
#include <vector>

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
  /// Integrates `samples` (increasing stamps, at least two) from the first stamp to the last one at
  /// the given bias. Between samples the mean of both ends is applied (midpoint rule); across a gap
  /// (ImuGapModel) that mean has extra noise.
  /// @param standstill  time that was left out of the samples, since the body stood still: only its
  ///                    biases walked on, as if before the first sample
  Preintegration(std::span<const ImuSample> samples,
                 ImuBias bias,
                 const ImuNoise& noise,
                 Duration standstill = {});

  [[nodiscard]] Duration duration() const;  ///< of the samples
  [[nodiscard]] Duration bias_walk_duration() const { return standstill_ + duration(); }
  [[nodiscard]] const ImuBias& bias() const;  ///< linearization point
  [[nodiscard]] const ImuNoise& noise() const;

  /// Covariance of the error of the deltas [rotation (right perturbation), position, velocity],
  /// given the bias at the start: white noise, and the bias random walk from there on.
  [[nodiscard]] const Matrix9d& covariance() const;

  /// Cross-covariance of that error and the walk of [gyroscope bias, accelerometer bias].
  [[nodiscard]] const Matrix96d& bias_walk_covariance() const;

  /// d deltas / d [gyroscope bias, accelerometer bias]
  [[nodiscard]] const Matrix96d& bias_jacobian() const;

  /// Deltas corrected to first order for another bias (Forster et al., eq. 44).
  struct Deltas {
    Eigen::Quaterniond R;
    Eigen::Vector3d p;
    Eigen::Vector3d v;
  };
  [[nodiscard]] Deltas deltas(const ImuBias& bias) const;

  /// The state at the end, from the state at the start (whose bias is used and copied).
  [[nodiscard]] NavState predict(const NavState& start) const;

  /// Integrates the same samples again, at another bias.
  [[nodiscard]] Preintegration relinearized(const ImuBias& bias) const;

 private:
  void integrate(const ImuSample& from, const ImuSample& to);

  std::vector<ImuSample> samples_;
  ImuBias bias_;
  ImuNoise noise_;
  Duration standstill_;
  Deltas deltas_{Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  Matrix9d covariance_ = Matrix9d::Zero();
  Matrix96d bias_jacobian_ = Matrix96d::Zero();
  Matrix96d bias_walk_covariance_ = Matrix96d::Zero();
};

}  // namespace fleetloc
