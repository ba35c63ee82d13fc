// What the stages before and after the optimization make of their values.
#include "cloud/localizer/prediction.hpp"

#include <gtest/gtest.h>

#include "cloud/localizer/map_fit.hpp"
#include "simulated_session.hpp"

namespace fleetloc {
namespace {

TEST(Prediction, IsAsUncertainFarAwayAsItsHeading) {
  const PoseWithCovariance heading{Pose{}, diagonal_covariance(0.05, 0.001)};
  const LandmarkPositions near{{LandmarkId{1}, {2.0, 0.0, 0.0}}};
  const LandmarkPositions far{{LandmarkId{1}, {0.0, 20.0, 0.0}}};
  EXPECT_NEAR(landmark_sigma(near, heading), 0.1, 1e-3);
  EXPECT_NEAR(landmark_sigma(far, heading), 1.0, 1e-3);
  const PoseWithCovariance place{Pose{}, diagonal_covariance(1e-6, 0.3)};
  EXPECT_NEAR(landmark_sigma(far, place), 0.3, 1e-3);
}

TEST(MapFit, MeasuresMatchesInTheirOwnStandardDeviations) {
  const AssociationConfig config = localizer_config().registration.association;
  MapMatch plane;
  plane.landmark.id = LandmarkId{1};
  plane.is_planar = true;
  plane.normal = Eigen::Vector3d::UnitZ();
  MapMatch point;
  point.landmark.id = LandmarkId{2};
  const LandmarkPositions positions{
      {LandmarkId{1}, {5.0, 5.0, -2.0 * config.plane_sigma_m}},
      {LandmarkId{2}, Eigen::Vector3d::Constant(2.0 * config.point_sigma_m)}};
  EXPECT_DOUBLE_EQ(median_residual({plane}, positions, config), 2.0);
  EXPECT_DOUBLE_EQ(median_residual({point}, positions, config), 2.0);
  EXPECT_DOUBLE_EQ(median_residual({}, positions, config), 0.0);
}

}  // namespace
}  // namespace fleetloc
