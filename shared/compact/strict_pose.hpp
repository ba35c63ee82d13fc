#pragma once

#include <array>

/// Poses whose arithmetic gives the same bits on every machine: additions, multiplications,
/// divisions and square roots of IEEE doubles, in the order in which they are written. Both ends of
/// the network predict from them, so a difference in the last bit would garble a sample. The
/// compiler must not contract products and sums (-ffp-contract=off), and nothing else may be used:
/// no library function, no vectorized sum.
namespace fleetloc {

using StrictVector = std::array<double, 3>;

/// Quaternion w, x, y, z; of unit length unless said otherwise.
using StrictRotation = std::array<double, 4>;

/// Row by row.
using StrictMatrix = std::array<StrictVector, 3>;

struct StrictPose {
  StrictMatrix R{};
  StrictVector p{};
};

StrictRotation normalized(const StrictRotation& q);  ///< expects a length above zero
StrictRotation conjugate(const StrictRotation& q);
StrictRotation product(const StrictRotation& a, const StrictRotation& b);
StrictMatrix matrix_of(const StrictRotation& q);

StrictVector sum(const StrictVector& a, const StrictVector& b);
StrictVector difference(const StrictVector& a, const StrictVector& b);
StrictVector scaled(const StrictVector& v, double factor);
StrictVector product(const StrictMatrix& R, const StrictVector& v);
StrictVector transposed_product(const StrictMatrix& R, const StrictVector& v);  ///< R^T v
StrictMatrix product(const StrictMatrix& a, const StrictMatrix& b);

/// To the nearest integer, halves upwards; clamped to [min, max], which not-a-number becomes min
/// of.
int rounded(double value, int min, int max);

}  // namespace fleetloc
