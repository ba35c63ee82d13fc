#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include <Eigen/LU>
#include <gmock/gmock.h>

#include "cloud/localizer/degeneracy.hpp"
#include "cloud/localizer/map_association.hpp"
#include "cloud/localizer/tilt_factor.hpp"
#include "cloud/localizer/weak_directions.hpp"
#include "shared/core/counter_random.hpp"
#include "shared/geometry/so3.hpp"
#include "simulated_session.hpp"

namespace fleetloc {
namespace {

const Pose kMatchedPose{exp_so3({0.3, -0.5, 2.0}), {1.0, -2.0, 0.5}};

// Matches on planes given by their normals, 3 m from the middle, with noise on the normals.
std::vector<MapMatch> matches_on(const std::vector<Eigen::Vector3d>& normals, int per_plane) {
  std::vector<MapMatch> matches;
  for (const Eigen::Vector3d& normal : normals) {
    const CounterRandom random(7, matches.size());
    for (int i = 0; i < per_plane; ++i) {
      const std::uint64_t counter = 2 * static_cast<std::uint64_t>(i);
      MapMatch match;
      Eigen::Vector3d along = 2.0 * random.normal3(counter);
      along -= normal * normal.dot(along);
      match.landmark.p_map = 3.0 * normal + along;
      match.q_map = match.landmark.p_map;
      match.normal = (normal + 0.02 * random.normal3(counter + 1)).normalized();
      match.is_planar = true;
      match.sigma_m = 0.03;
      matches.push_back(match);
    }
  }
  return matches;
}

TEST(TiltFactor, HasTheJacobianOfItsResidualAndIsBlindToYawAndPosition) {
  const TiltFactor factor(Eigen::Vector3d(0.1, -0.3, 0.9).normalized(), 0.01);
  const auto residual = [&](const Pose& T) {
    const PoseParameters values = to_parameters(T);
    const std::array<const double*, 1> parameters{values.data()};
    Eigen::Vector2d r;
    factor.Evaluate(parameters.data(), r.data(), nullptr);
    return r;
  };
  const PoseParameters values = to_parameters(kMatchedPose);
  const std::array<const double*, 1> parameters{values.data()};
  Eigen::Vector2d r;
  Eigen::Matrix<double, 2, 7, Eigen::RowMajor> J;
  std::array jacobians{J.data()};
  factor.Evaluate(parameters.data(), r.data(), jacobians.data());
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = 1e-6 * Vector6d::Unit(i);
    const Eigen::Vector2d numeric =
        (residual(retract(kMatchedPose, step)) - residual(retract(kMatchedPose, -step))) / 2e-6;
    EXPECT_LT((J.col(i) - numeric).norm(), 1e-6);
  }
  const Pose turned{exp_so3({0.0, 0.0, 1.0}) * kMatchedPose.R,
                    kMatchedPose.p + Eigen::Vector3d(1.0, 2.0, 3.0)};
  EXPECT_LT((residual(turned) - r).norm(), 1e-9);
}

TEST(WindowMotion, MovesABodyAsItsJacobianSays) {
  const WindowMotion motion{{0.5, 1.5, -1.0}, 2.5};
  const Matrix6d J = motion.J_body_motion(kMatchedPose);
  for (int i = 0; i < 6; ++i) {
    const Vector6d coordinates = 1e-6 * Vector6d::Unit(i);
    const Eigen::Quaterniond R = exp_so3(coordinates.head<3>() / motion.lever_m);
    const Pose moved{
        R * kMatchedPose.R,
        motion.center_map + R * (kMatchedPose.p - motion.center_map) + coordinates.tail<3>()};
    EXPECT_LT((local_coordinates(kMatchedPose, moved) / 1e-6 - J.col(i)).norm(), 1e-5);
  }
}

TEST(WindowMotion, MovesAPointAsItsGradientSays) {
  const WindowMotion motion{{0.5, 1.5, -1.0}, 2.5};
  const Eigen::Vector3d p_map{3.0, -4.0, 2.0};
  const Eigen::Vector3d direction = Eigen::Vector3d(0.3, -0.5, 0.9).normalized();
  const auto along = [&](const Vector6d& coordinates) {
    const Eigen::Quaterniond R = exp_so3(coordinates.head<3>() / motion.lever_m);
    return direction.dot(motion.center_map + R * (p_map - motion.center_map) +
                         coordinates.tail<3>());
  };
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = 1e-6 * Vector6d::Unit(i);
    EXPECT_NEAR(motion.gradient(direction, p_map)(i), (along(step) - along(-step)) / 2e-6, 1e-8);
  }
}

constexpr double kNormalSigma = 0.03;  // [rad]

TEST(MapConstraint, FindsTheWeakDirectionsOfAPlaneACorridorAndARoom) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const auto weak = [](const std::vector<MapMatch>& matches, double sigma_m) {
    return analyze_map_constraint(matches, kNormalSigma).weaker_than(sigma_m).cols();
  };
  EXPECT_EQ(weak(matches_on({x}, 400), 0.025), 3);
  EXPECT_EQ(weak(matches_on({x, y, z}, 130), 0.025), 0);
  EXPECT_EQ(weak(matches_on({x, y, z}, 130), 0.002), 6);
  EXPECT_EQ(weak({}, 0.025), 6);

  const MapConstraint corridor =
      analyze_map_constraint(matches_on({y, -y, z, -z}, 100), kNormalSigma);
  ASSERT_EQ(corridor.weaker_than(0.025).cols(), 1);
  EXPECT_GT(std::abs(corridor.weaker_than(0.025)(3, 0)), 0.99);
  EXPECT_GT(corridor.sigmas_m(0), 0.1);
  EXPECT_LT(corridor.sigmas_m(1), 0.01);
}

TEST(MapConstraint, CountsAnUncertainLandmarkLess) {
  std::vector<MapMatch> matches = matches_on({Eigen::Vector3d::UnitX()}, 100);
  const double before = analyze_map_constraint(matches, kNormalSigma).sigmas_m(5);
  for (MapMatch& match : matches) match.landmark.covariance.setIdentity();
  EXPECT_GT(analyze_map_constraint(matches, kNormalSigma).sigmas_m(5), 20.0 * before);
}

TEST(WeakDirections, AreNeverClaimedToBeKnownBetterThanBefore) {
  const WindowMotion motion{{0.5, 1.5, -1.0}, 2.5};
  WeakDirections weak(6, 2);
  weak << Vector6d::Unit(3), Vector6d::Unit(2);
  const Matrix6d wide = 0.04 * Matrix6d::Identity();
  const Matrix6d narrow = 1e-4 * Matrix6d::Identity();

  const Matrix6d W = motion.J_body_motion(kMatchedPose).inverse();
  const Matrix6d expected = W * wide * W.transpose();
  const Matrix6d known = W * narrow * W.transpose();
  const Matrix6d widened =
      W * widened_along(weak, motion, {kMatchedPose, narrow}, wide) * W.transpose();
  EXPECT_NEAR(widened(3, 3), expected(3, 3), 1e-9);
  EXPECT_NEAR(widened(2, 2), expected(2, 2), 1e-9);
  EXPECT_NEAR(widened(4, 4), known(4, 4), 1e-9);
  EXPECT_NEAR(weak_sigma(weak, motion, {kMatchedPose, narrow}),
              std::sqrt(std::max(known(3, 3), known(2, 2))),
              1e-9);
  EXPECT_TRUE(widened_along(weak, motion, {kMatchedPose, wide}, narrow).isApprox(wide));
  EXPECT_EQ(weak_sigma(WeakDirections(6, 0), motion, {kMatchedPose, wide}), 0.0);
}

TEST(Association, SharesTheInformationOfACellAndWidensTheGateByUncertainty) {
  std::vector<MapPoint> points;
  for (int i = 0; i < 100; ++i) {
    const std::div_t place = std::div(i, 10);
    const auto x = static_cast<float>(place.rem);
    const auto y = static_cast<float>(place.quot);
    points.push_back({{0.1F * x, 0.1F * y, 0.0F}, Eigen::Vector3f::UnitZ(), 1.0F});
  }
  const LaserMap map(points, {.frame = "map", .resolution_m = 0.1});
  const AssociationConfig config = localizer_config().registration.association;
  const auto landmark = [](unsigned id, double x, double z) {
    return WindowLandmark{
        LandmarkId{id}, {x, 0.05, z}, {0.5, 0.5, 2.0}, 1e-6 * Eigen::Matrix3d::Identity()};
  };
  const auto one = associate({landmark(1, 0.1, 0.02)}, map, 0.12, config);
  ASSERT_EQ(one.matches.size(), 1U);
  EXPECT_DOUBLE_EQ(one.matches[0].sigma_m, config.plane_sigma_m);
  EXPECT_DOUBLE_EQ(one.matches[0].widening, 1.0);

  std::vector<WindowLandmark> crowd;
  for (unsigned i = 0; i < 8; ++i) crowd.push_back(landmark(i, 0.02 * i, 0.02));
  const auto many = associate(crowd, map, 0.12, config);
  ASSERT_EQ(many.matches.size(), 8U);
  EXPECT_NEAR(many.matches[0].sigma_m, config.plane_sigma_m * std::sqrt(4.0), 1e-9);

  WindowLandmark far = landmark(1, 0.1, 0.3);
  EXPECT_EQ(associate({far}, map, 0.12, config).matches.size(), 0U);
  EXPECT_EQ(associate({far}, map, 0.12, config).covered, 1);
  far.covariance(2, 2) = 0.04;
  EXPECT_EQ(associate({far}, map, 0.12, config).matches.size(), 1U);
  far.covariance(2, 2) = 1.0;
  EXPECT_EQ(associate({far}, map, 0.12, config).eligible, 0);
}

}  // namespace
}  // namespace fleetloc
