#pragma once

#include <cmath>

#include <Eigen/Cholesky>

namespace fleetloc {

struct Mean {
  double sum = 0.0;
  int count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  [[nodiscard]] double value() const { return sum / count; }
  [[nodiscard]] double root() const { return std::sqrt(value()); }
};

/// Per degree of freedom.
template <typename Vector, typename Matrix>
double nees_of(const Vector& error, const Matrix& covariance) {
  return error.dot(covariance.ldlt().solve(error)) / static_cast<double>(error.size());
}

}  // namespace fleetloc
