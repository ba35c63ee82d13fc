#include "shared/geometry/covariance.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

TEST(MaxSigma, IsThatOfTheWidestDirection) {
  const Eigen::Matrix3d R = exp_so3({0.3, -1.1, 0.7}).toRotationMatrix();
  for (const Eigen::Vector3d& sigmas : {Eigen::Vector3d(0.1, 0.2, 0.3),
                                        {2.0, 2.0, 2.0},
                                        {0.0, 0.0, 5.0},
                                        {0.0, 0.0, 0.0},
                                        {1e-6, 1e-3, 1e3},
                                        {3.0, 3.0, 1e-9}}) {
    const Eigen::Matrix3d covariance = R * sigmas.cwiseAbs2().asDiagonal() * R.transpose();
    EXPECT_NEAR(max_sigma(covariance), sigmas.maxCoeff(), 1e-9 * sigmas.maxCoeff())
        << sigmas.transpose();
  }
}

TEST(MaxSigma, IsNoneWithoutACovariance) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(max_sigma(Eigen::Matrix3d::Constant(kNaN))));
  EXPECT_TRUE(std::isnan(max_sigma(-Eigen::Matrix3d::Identity())));
}

}  // namespace
}  // namespace fleetloc
