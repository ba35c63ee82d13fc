#include "deploy/sim/motion/quintic_spline.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace fleetloc {
namespace {

constexpr int kOrder = kQuinticSupport;
constexpr int kBand = kQuinticSupport;  // diagonals of the lower half of the normal equations

using Square = Eigen::Matrix<double, kOrder, kOrder>;
/// Lower half of a symmetric band matrix: element (column + d, column) is at (d, column).
using Band = Eigen::Matrix<double, kBand, Eigen::Dynamic>;

double binomial(int n, int k) {
  double result = 1.0;
  for (int i = 1; i <= k; ++i) result *= static_cast<double>(n - k + i) / i;
  return result;
}

/// Row: coefficient of the spline; column: power of u. Qin, General matrix representations for
/// B-splines, 2000.
Square basis_matrix() {
  constexpr double kFactorial = 120.0;  // (order - 1)!
  Square M = Square::Zero();
  for (int row = 0; row < kOrder; ++row) {
    for (int power = 0; power < kOrder; ++power) {
      double sum = 0.0;
      for (int l = row; l < kOrder; ++l) {
        const double sign = (l - row) % 2 == 0 ? 1.0 : -1.0;
        sum += sign * binomial(kOrder, l - row) *
               std::pow(static_cast<double>(kOrder - 1 - l), kOrder - 1 - power);
      }
      M(row, power) = binomial(kOrder - 1, power) / kFactorial * sum;
    }
  }
  return M;
}

const Square& basis() {
  static const Square M = basis_matrix();
  return M;
}

/// Integrals over one interval of products of third derivatives by u.
Square jerk_products() {
  Square D = Square::Zero();
  for (int a = 3; a < kOrder; ++a) {
    for (int b = 3; b < kOrder; ++b) {
      const double factor = static_cast<double>(a * (a - 1) * (a - 2) * b * (b - 1) * (b - 2)) /
                            static_cast<double>(a + b - 5);
      D += factor * basis().col(a) * basis().col(b).transpose();
    }
  }
  return D;
}

void add(Band& band, int first, const Square& block) {
  for (int column = 0; column < kOrder; ++column) {
    for (int row = column; row < kOrder; ++row) {
      band(row - column, first + column) += block(row, column);
    }
  }
}

void factorize(Band& band) {
  const Eigen::Index size = band.cols();
  for (Eigen::Index j = 0; j < size; ++j) {
    if (!(band(0, j) > 0.0)) {
      throw std::invalid_argument("the samples do not determine a spline");
    }
    band.col(j) /= std::sqrt(band(0, j));
    const Eigen::Index last = std::min<Eigen::Index>(kBand - 1, size - 1 - j);
    for (Eigen::Index k = 1; k <= last; ++k) {
      const Eigen::Index count = kBand - k;
      band.col(j + k).head(count) -= band(k, j) * band.col(j).tail(count);
    }
  }
}

void solve_in_place(const Band& factor, Eigen::MatrixXd& right) {
  const Eigen::Index size = factor.cols();
  for (Eigen::Index j = 0; j < size; ++j) {
    right.row(j) /= factor(0, j);
    const Eigen::Index last = std::min<Eigen::Index>(kBand - 1, size - 1 - j);
    for (Eigen::Index k = 1; k <= last; ++k) right.row(j + k) -= factor(k, j) * right.row(j);
  }
  for (Eigen::Index j = size - 1; j >= 0; --j) {
    const Eigen::Index last = std::min<Eigen::Index>(kBand - 1, size - 1 - j);
    for (Eigen::Index k = 1; k <= last; ++k) right.row(j) -= factor(k, j) * right.row(j + k);
    right.row(j) /= factor(0, j);
  }
}

bool holds_three_times(const std::vector<double>& times_s) {
  std::vector<double> sorted = times_s;
  std::ranges::sort(sorted);
  const auto end = std::unique(sorted.begin(), sorted.end());
  return end - sorted.begin() >= 3;
}

}  // namespace

Eigen::Matrix<double, kQuinticSupport, 3> quintic_basis(double u) {
  Eigen::Matrix<double, kOrder, 3> powers;
  for (int i = 0; i < kOrder; ++i) {
    powers(i, 0) = i < 1 ? 1.0 : powers(i - 1, 0) * u;
    powers(i, 1) = i < 1 ? 0.0 : i * powers(i - 1, 0);
    powers(i, 2) = i < 2 ? 0.0 : i * (i - 1) * powers(i - 2, 0);
  }
  return basis() * powers;
}

SplineGrid::Place SplineGrid::place(double time_s) const {
  const double position = std::clamp(time_s / interval_s, 0.0, static_cast<double>(intervals));
  const int interval = std::min(static_cast<int>(position), intervals - 1);
  return {.interval = interval, .u = position - interval};
}

SplineGrid grid_over(double duration_s, double interval_s) {
  constexpr double kSlack = 1e-9;
  const double intervals = std::ceil(duration_s / interval_s - kSlack);
  return {.interval_s = interval_s, .intervals = std::max(1, static_cast<int>(intervals))};
}

Eigen::MatrixXd fit_quintic_spline(const SplineGrid& grid,
                                   const SplineSamples& samples,
                                   std::span<const double> penalties) {
  if (!holds_three_times(samples.times_s)) {
    throw std::invalid_argument("fewer than three times do not determine a spline");
  }
  // Coordinates far from zero would cost digits: the spline of what differs from the mean.
  const Eigen::RowVectorXd mean = samples.values.colwise().mean();
  Band band = Band::Zero(kBand, grid.coefficients());
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(grid.coefficients(), samples.values.cols());
  for (std::size_t i = 0; i < samples.times_s.size(); ++i) {
    const auto [interval, u] = grid.place(samples.times_s[i]);
    const Eigen::Matrix<double, kOrder, 1> b = quintic_basis(u).col(0);
    add(band, interval, samples.weights[i] * b * b.transpose());
    right.middleRows(interval, kOrder) +=
        samples.weights[i] * b * (samples.values.row(static_cast<Eigen::Index>(i)) - mean);
  }
  const Square jerk = jerk_products() / std::pow(grid.interval_s, 5);
  for (int k = 0; k < grid.intervals; ++k) {
    add(band, k, penalties[static_cast<std::size_t>(k)] * jerk);
  }
  factorize(band);
  solve_in_place(band, right);
  return right.rowwise() + mean;
}

Eigen::MatrixXd spline_values(const SplineGrid& grid,
                              const Eigen::MatrixXd& coefficients,
                              std::span<const double> times_s) {
  Eigen::MatrixXd values(static_cast<Eigen::Index>(times_s.size()), coefficients.cols());
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    const auto [interval, u] = grid.place(times_s[i]);
    values.row(static_cast<Eigen::Index>(i)) =
        quintic_basis(u).col(0).transpose() * coefficients.middleRows(interval, kOrder);
  }
  return values;
}

double penalty_for_cutoff(double cutoff_hz, double sample_interval_s) {
  const double omega = 2.0 * std::numbers::pi * cutoff_hz;
  return 1.0 / (sample_interval_s * std::pow(omega, 6));
}

}  // namespace fleetloc
