#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include <Eigen/Core>
#include <idl/common.h>

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/wire/malformed.hpp"

/// What several types have in common: conversions, which expect a valid field, and checks.
namespace fleetloc {

/// Larger coordinates are rejected [m]; geocentric ones still fit.
inline constexpr double kMaxCoordinate = 1e8;
/// How far the norm of a rotation's quaternion may be from one.
inline constexpr double kUnitNormTolerance = 1e-6;
/// Of a round trip, which is never negative.
inline constexpr Duration kNotMeasured{-1};

wire::Vector3 to_wire(const Eigen::Vector3d& vector);
wire::Pose to_wire(const Pose& T);
Eigen::Vector3d from_wire(const wire::Vector3& vector);
Pose from_wire(const wire::Pose& T);  ///< the rotation is normalized

/// Upper triangle of R with R^T R = matrix, row by row, in single precision: what is decoded is
/// positive semi-definite, and right to about 1e-7 of the square root of its diagonal entries.
/// Throws NotEncodable unless the matrix is finite, symmetric and positive semi-definite.
using SquareRoot = std::array<float, 21>;
SquareRoot square_root_of(const Matrix6d& matrix);
Matrix6d squared(std::span<const float, 21> square_root);

wire::SquareRoot6 to_wire(const Matrix6d& matrix);
Matrix6d from_wire(const wire::SquareRoot6& matrix);

constexpr std::int64_t to_wire(Timestamp stamp) {
  return stamp.time_since_epoch().count();
}
constexpr Timestamp stamp_from_wire(std::int64_t ns) {
  return Timestamp{Duration{ns}};
}

Validity check(double value, double min, double max);  ///< finite and within [min, max]
Validity check(const wire::Vector3& vector, double max = kMaxCoordinate);
Validity check(const wire::Pose& T);
Validity check(std::span<const float, 21> square_root);
Validity check(const wire::SquareRoot6& matrix);
/// Within 146 years of zero, so that differences do not overflow.
Validity check_stamp(std::int64_t ns);

/// Throws NotEncodable.
void expect_encodable_id(const std::string& id);
void expect_encodable(const Validity& valid, const std::string& what);

}  // namespace fleetloc
