#include "shared/compact/strict_pose.hpp"

#include <cmath>
#include <cstddef>

namespace fleetloc {

StrictRotation normalized(const StrictRotation& q) {
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
}

StrictRotation conjugate(const StrictRotation& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

StrictRotation product(const StrictRotation& a, const StrictRotation& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

StrictMatrix matrix_of(const StrictRotation& q) {
  const double w = q[0];
  const double x = q[1];
  const double y = q[2];
  const double z = q[3];
  return {{{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
           {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
           {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}}};
}

StrictVector sum(const StrictVector& a, const StrictVector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

StrictVector difference(const StrictVector& a, const StrictVector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

StrictVector scaled(const StrictVector& v, double factor) {
  return {v[0] * factor, v[1] * factor, v[2] * factor};
}

StrictVector product(const StrictMatrix& R, const StrictVector& v) {
  StrictVector out{};
  for (std::size_t row = 0; row < 3; ++row) {
    out[row] = R[row][0] * v[0] + R[row][1] * v[1] + R[row][2] * v[2];
  }
  return out;
}

StrictVector transposed_product(const StrictMatrix& R, const StrictVector& v) {
  StrictVector out{};
  for (std::size_t column = 0; column < 3; ++column) {
    out[column] = R[0][column] * v[0] + R[1][column] * v[1] + R[2][column] * v[2];
  }
  return out;
}

StrictMatrix product(const StrictMatrix& a, const StrictMatrix& b) {
  StrictMatrix out{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      out[row][column] =
          a[row][0] * b[0][column] + a[row][1] * b[1][column] + a[row][2] * b[2][column];
    }
  }
  return out;
}

int rounded(double value, int min, int max) {
  if (!(value > min)) return min;
  if (value >= max) return max;
  return static_cast<int>(std::floor(value + 0.5));
}

}  // namespace fleetloc
