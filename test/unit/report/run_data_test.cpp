#include "deploy/evaluation/report/run_data.hpp"

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr double kDegPerRad = 57.29577951308232;

TEST(MapSigmas, AreThoseOfTheBodyTurnedToTheMap) {
  // The body's x axis points along the map's y axis, its y axis up.
  Eigen::Matrix3d R;
  R.col(0) = Eigen::Vector3d::UnitY();
  R.col(1) = Eigen::Vector3d::UnitZ();
  R.col(2) = Eigen::Vector3d::UnitX();
  const Pose T_map_body{.R = Eigen::Quaterniond(R), .p = {1.0, 2.0, 3.0}};
  const Vector6d sigmas_body = (Vector6d() << 0.1, 0.2, 0.3, 1.0, 2.0, 3.0).finished();
  const MapSigmas sigmas = map_sigmas(T_map_body, sigmas_body.cwiseAbs2().asDiagonal());
  EXPECT_TRUE(sigmas.position_m.isApprox(Eigen::Vector3d(3.0, 1.0, 2.0), 1e-9));
  EXPECT_NEAR(sigmas.yaw_deg, 0.2 * kDegPerRad, 1e-9);
}

TEST(Errors, AreEstimateMinusTruthInTheMap) {
  const Pose T_truth_body{.R = exp_so3({0.3, -0.2, 1.0}), .p = {1.0, 2.0, 3.0}};
  const Pose T_estimate_body{.R = exp_so3({0.0, 0.0, 0.05}) * T_truth_body.R, .p = {1.5, 2.0, 2.0}};
  const PosePair pair{{}, T_truth_body, T_estimate_body};
  EXPECT_TRUE(position_error(pair).isApprox(Eigen::Vector3d(0.5, 0.0, -1.0), 1e-12));
  EXPECT_NEAR(yaw_error_deg(pair), 0.05 * kDegPerRad, 1e-9);
}

}  // namespace
}  // namespace fleetloc
