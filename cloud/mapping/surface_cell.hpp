#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace fleetloc {

/// The surface in a cell, as a test of whether a ray passes through it.
struct SurfaceCell {
  enum class Kind : std::uint8_t {
    kPlanar,     ///< a plane with this `normal`
    kNonPlanar,  ///< upright and thin, as a pole, or scattered
    kUnknown,    ///< a level line, as of one ring on the ground: its plane is unknown
  };

  Eigen::Vector3f p_map = Eigen::Vector3f::Zero();   ///< mean of the points [m]
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit; if planar
  /// Inverse covariance of the points, with 2 cm of noise added [1/m^2].
  Eigen::Matrix3f information = Eigen::Matrix3f::Zero();
  Kind kind = Kind::kUnknown;
};

/// Sums of points, from which the principal axes follow.
class PointMoments {
 public:
  /// @param offset  from the origin of these moments [m]
  void add(const Eigen::Vector3f& offset);
  /// Of other moments, whose origin is `shift` from this one.
  void add(const PointMoments& other, const Eigen::Vector3f& shift);

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] Eigen::Vector3f mean() const { return sum_ / static_cast<float>(count_); }
  [[nodiscard]] Eigen::Matrix3f covariance() const;

 private:
  int count_ = 0;
  Eigen::Vector3f sum_ = Eigen::Vector3f::Zero();
  Eigen::Matrix3f squares_ = Eigen::Matrix3f::Zero();
};

/// @param own      moments of the cell, at least one point
/// @param around   of the cell and its neighbours; used for cells with few points
/// @param origin_map  origin of both [m]
SurfaceCell surface_of(const PointMoments& own,
                       const PointMoments& around,
                       const Eigen::Vector3f& origin_map);

}  // namespace fleetloc
