#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace fleetloc {

/// Coefficients that act on one interval between knots.
inline constexpr int kQuinticSupport = 6;

/// Uniform B-spline basis of degree five, four times continuously differentiable.
/// @param u  position within an interval between knots, 0..1
/// @return   one row per coefficient that acts there; columns: value, first and second derivative
///           by u
Eigen::Matrix<double, kQuinticSupport, 3> quintic_basis(double u);

/// Knots at 0, interval_s, 2 interval_s, ..., intervals * interval_s.
struct SplineGrid {
  double interval_s = 0.0;
  int intervals = 0;

  [[nodiscard]] int coefficients() const { return intervals + kQuinticSupport - 1; }
  [[nodiscard]] double duration_s() const { return interval_s * intervals; }
  /// The interval that holds `time_s`, and the position in it in units of the interval. Times
  /// outside of the grid are moved to its ends.
  struct Place {
    int interval = 0;
    double u = 0.0;
  };
  [[nodiscard]] Place place(double time_s) const;
};

/// The smallest grid of that interval that reaches `duration_s`.
SplineGrid grid_over(double duration_s, double interval_s);

/// Data that a spline is fitted to: one row of `values` and one weight per time. Times in any
/// order, also equal ones.
struct SplineSamples {
  std::vector<double> times_s;
  std::vector<double> weights;
  Eigen::MatrixXd values;
};

/// The smoothing spline (Reinsch 1967, with a jerk penalty in the manner of the P-splines of Eilers
/// and Marx 1996): minimizes
///   sum_i weight_i |x(t_i) - value_i|^2 + sum_k penalty_k * integral over interval k of |x'''|^2
///   dt
/// by one banded Cholesky factorization, in time linear in the number of knots.
/// @param penalties  one per interval, positive; in units of weight * s^5
/// @return           one row per coefficient, one column per column of the values
/// Throws std::invalid_argument if the samples do not determine a spline (fewer than three times).
Eigen::MatrixXd fit_quintic_spline(const SplineGrid& grid,
                                   const SplineSamples& samples,
                                   std::span<const double> penalties);

/// The values of a spline at the times, one row each.
Eigen::MatrixXd spline_values(const SplineGrid& grid,
                              const Eigen::MatrixXd& coefficients,
                              std::span<const double> times_s);

/// The penalty at which the smoothing spline passes half of the amplitude of a sine of frequency
/// `cutoff_hz`, for samples of weight one every `sample_interval_s`: its frequency response is
/// 1 / (1 + penalty * sample_interval * omega^6).
double penalty_for_cutoff(double cutoff_hz, double sample_interval_s);

}  // namespace fleetloc
