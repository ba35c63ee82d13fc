#include "shared/wire/fields.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include "shared/core/ids.hpp"

namespace fleetloc {
namespace {

constexpr double kLargestRoot = 1e9;  // of an information: 1 nrad, 1 nm
constexpr double kSymmetryTolerance = 1e-6;
constexpr double kNegativeEigenvalueTolerance = 1e-9;
constexpr std::int64_t kLatestStamp_ns = std::int64_t{1} << 62;

void expect(bool holds, const char* what) {
  if (!holds) throw NotEncodable(what);
}

}  // namespace

wire::Vector3 to_wire(const Eigen::Vector3d& vector) {
  wire::Vector3 out;
  out.x(vector.x());
  out.y(vector.y());
  out.z(vector.z());
  return out;
}

wire::Pose to_wire(const Pose& T) {
  wire::Pose out;
  out.rotation().w(T.R.w());
  out.rotation().x(T.R.x());
  out.rotation().y(T.R.y());
  out.rotation().z(T.R.z());
  out.translation(to_wire(T.p));
  return out;
}

Eigen::Vector3d from_wire(const wire::Vector3& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Pose from_wire(const wire::Pose& T) {
  const wire::Quaternion& q = T.rotation();
  return {Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized(), from_wire(T.translation())};
}

SquareRoot square_root_of(const Matrix6d& matrix) {
  expect(matrix.allFinite(), "a matrix that is not finite");
  expect((matrix.diagonal().array() >= 0.0).all(), "a matrix with a negative diagonal");
  // Rotations and translations differ by orders of magnitude: the root is that of the correlations.
  const Vector6d scale =
      matrix.diagonal().cwiseSqrt().unaryExpr([](double s) { return s > 0.0 ? s : 1.0; });
  const Matrix6d correlation =
      scale.cwiseInverse().asDiagonal() * matrix * scale.cwiseInverse().asDiagonal();
  expect((correlation - correlation.transpose()).cwiseAbs().maxCoeff() <= kSymmetryTolerance,
         "a matrix that is not symmetric");
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(0.5 *
                                                      (correlation + correlation.transpose()));
  expect(eigen.eigenvalues().minCoeff() >= -kNegativeEigenvalueTolerance,
         "a matrix that is not positive semi-definite");
  const Matrix6d root =
      eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
  const Matrix6d R = root.householderQr().matrixQR();
  SquareRoot out{};
  auto* next = out.data();
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      *next++ = static_cast<float>(R(row, column) * scale(column));
    }
  }
  expect(check(std::span<const float, 21>(out)).has_value(), "a matrix that is out of range");
  return out;
}

Matrix6d squared(std::span<const float, 21> square_root) {
  Matrix6d R = Matrix6d::Zero();
  auto next = square_root.begin();
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) R(row, column) = static_cast<double>(*next++);
  }
  return R.transpose() * R;
}

wire::SquareRoot6 to_wire(const Matrix6d& matrix) {
  wire::SquareRoot6 out;
  out.R(square_root_of(matrix));
  return out;
}

Matrix6d from_wire(const wire::SquareRoot6& matrix) {
  return squared(matrix.R());
}

Validity check(double value, double min, double max) {
  if (!std::isfinite(value)) return unexpected(Malformed::kNotFinite);
  if (value < min || value > max) return unexpected(Malformed::kOutOfRange);
  return {};
}

Validity check(const wire::Vector3& vector, double max) {
  for (const double value : {vector.x(), vector.y(), vector.z()}) {
    if (const Validity valid = check(value, -max, max); !valid) return valid;
  }
  return {};
}

Validity check(const wire::Pose& T) {
  const wire::Quaternion& q = T.rotation();
  const Eigen::Vector4d coefficients(q.w(), q.x(), q.y(), q.z());
  if (!coefficients.allFinite()) return unexpected(Malformed::kNotFinite);
  if (!(std::abs(coefficients.norm() - 1.0) <= kUnitNormTolerance))
    return unexpected(Malformed::kNotARotation);
  return check(T.translation());
}

Validity check(std::span<const float, 21> square_root) {
  for (const float value : square_root) {
    if (const Validity valid = check(static_cast<double>(value), -kLargestRoot, kLargestRoot);
        !valid) {
      return valid;
    }
  }
  return {};
}

Validity check(const wire::SquareRoot6& matrix) {
  return check(std::span<const float, 21>(matrix.R()));
}

Validity check_stamp(std::int64_t ns) {
  if (ns < -kLatestStamp_ns || ns > kLatestStamp_ns) return unexpected(Malformed::kOutOfRange);
  return {};
}

void expect_encodable_id(const std::string& id) {
  if (!is_valid_id(id)) throw NotEncodable("'" + id + "' is not an id");
}

void expect_encodable(const Validity& valid, const std::string& what) {
  if (!valid) throw NotEncodable(what + ": " + std::string(name(valid.error())));
}

}  // namespace fleetloc
