#include "robot/pipeline/map_odom_estimate.hpp"

#include <random>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// What a person says of a pose in the map, as seen at the origin of odom some metres away.
TEST(MapOdomEstimate, HasTheCovarianceOfPosesDrawnAroundIt) {
  constexpr StartUncertainty kSigma{.position_sigma_m = 0.05,
                                    .yaw_sigma_rad = 0.02,
                                    .tilt_sigma_rad = 0.004,
                                    .max_carried_sigma_m = 1.0};
  constexpr int kDraws = 40'000;
  const Pose T_map_body{exp_so3({0.7, -1.2, 2.0}), {12.0, -3.0, 1.0}};
  const Pose T_odom_body{exp_so3({-0.4, 0.9, 0.3}), {4.0, 2.0, -1.5}};
  const MapOdomEstimate start = map_odom_estimate_at(T_map_body, T_odom_body, kSigma);

  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Matrix6d sum = Matrix6d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const auto draw = [&](double sigma) { return sigma * normal(random); };
    const double roll = draw(kSigma.tilt_sigma_rad);
    const double pitch = draw(kSigma.tilt_sigma_rad);
    const double yaw = draw(kSigma.yaw_sigma_rad);
    const Eigen::Vector3d shift =
        Eigen::Vector3d::NullaryExpr([&] { return draw(kSigma.position_sigma_m); });
    const Pose truth{exp_so3({roll, pitch, yaw}) * T_map_body.R, T_map_body.p + shift};
    const Vector6d error = local_coordinates(start.T_map_odom, truth * inverse(T_odom_body));
    sum += error * error.transpose();
  }
  EXPECT_LT((sum / kDraws - start.covariance).norm(), 0.03 * start.covariance.norm());
  const Pose back = start.T_map_odom * T_odom_body;
  EXPECT_LT(local_coordinates(back, T_map_body).norm(), 1e-12);
}

}  // namespace
}  // namespace fleetloc
