#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/map_association.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

struct ShiftProfileConfig {
  bool is_used;       ///< by a session
  double step_m;      ///< between the shifts that are tried
  int steps;          ///< to either side, along each of two axes
  int found_steps;    ///< the same for a place that a search has found
  int max_landmarks;  ///< evenly sampled; further ones repeat the errors of these
};

/// The landmarks where the robot alone sees them from the keyframes' present poses, without those
/// on level surfaces: what the matches have drawn them by is taken back, to first order. So they do
/// not speak for a place only because they were optimized there.
/// @param landmarks   increasing
/// @param matches     of these, as they were optimized; increasing by landmark
/// @param map_kernel  of the matches, Cauchy [standard deviations]
std::vector<WindowLandmark> seen_without_map(std::vector<WindowLandmark> landmarks,
                                             const std::vector<MapMatch>& matches,
                                             double map_kernel);

/// How uncertain the place of a window is on the level, beyond what the curvature of its cost
/// tells: zero where it fits there and nowhere near, much where most of what it sees has changed.
/// What has changed finds matches by chance wherever it is, so a cost that has a minimum may be
/// flat around it.
///
/// The likelihood of shifts along the two principal axes of the matches' information is sampled,
/// and its second moment about the place taken (E. Olson, Real-time correlative scan matching, ICRA
/// 2009); what a quadratic cost of the same information would have is subtracted. Landmarks of one
/// object share the errors of its place, so that the scores are tempered.
class ShiftProfile {
 public:
  /// @param landmarks    of seen_without_map()
  /// @param gate_m       of the association
  /// @param temperature  score in which the odds of a place fall by e
  ShiftProfile(const std::vector<WindowLandmark>& landmarks,
               const LaserMap& map,
               double gate_m,
               const AssociationConfig& association,
               const ShiftProfileConfig& config,
               double temperature);

  /// Covariance in excess, of the shift in x and y of the map [m^2].
  [[nodiscard]] Eigen::Matrix2d excess() const;

  /// Widens the matches along both axes, so that together they tell of a shift no more than is
  /// true.
  void widen(std::vector<MapMatch>& matches) const;

 private:
  struct Axis {
    Eigen::Vector2d direction_map = Eigen::Vector2d::Zero();
    double excess_m2 = 0.0;
  };
  std::array<Axis, 2> axes_;
};

ShiftProfileConfig read_shift_profile_config(ConfigReader section);

}  // namespace fleetloc
