#pragma once

#include <gtest/gtest.h>

#include "test/unit/fusion/fed_fusion.hpp"

namespace fleetloc {

inline bool identical(const Pose& a, const Pose& b) {
  return a.R.coeffs() == b.R.coeffs() && a.p == b.p;
}

inline double distance(const Pose& a, const Pose& b) {
  return local_coordinates(a, b).norm();
}

inline Pose moved(const Pose& T, double x) {
  return {T.R, T.p + Eigen::Vector3d(x, 0.0, 0.0)};
}

// Both formulations.
class EitherFusion : public testing::TestWithParam<PoseFusion::Formulation> {
 protected:
  static PoseFusion::Config config() {
    PoseFusion::Config result = fusion_config();
    result.formulation = GetParam();
    return result;
  }
  static bool is_single() { return GetParam() == PoseFusion::Formulation::kCoupled; }
  /// The single filter takes the map for level; this one is tilted by 2 mrad.
  static double tolerance() { return is_single() ? 6e-3 : 2e-3; }
};

inline constexpr auto kFormulation = [](const auto& tested) {
  return tested.param == PoseFusion::Formulation::kDecoupled ? "Decoupled" : "Coupled";
};

}  // namespace fleetloc
