// What a window tells of its place where much of what it sees has changed since the survey.
#include "cloud/localizer/shift_profile.hpp"

#include <cmath>
#include <iostream>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "cloud/localizer/map_association.hpp"
#include "shared/core/counter_random.hpp"
#include "simulated_session.hpp"
#include "simulated_yard.hpp"

namespace fleetloc {
namespace {

constexpr double kTemperature = 10.0;
constexpr double kObject_m = 2.0;  // length along a wall of what was moved together

ShiftProfile profile_of(const std::vector<WindowLandmark>& landmarks, const LaserMap& map) {
  const auto config = localizer_config().registration;
  return {landmarks,
          map,
          config.rounds.final_gate_m,
          config.association,
          config.shift_profile,
          kTemperature};
}

/// The yard with a share of what stands along the walls across x moved along it, object by object.
std::vector<WindowLandmark> changed_across_x(double share, unsigned seed) {
  const CounterRandom random(seed, 0);
  auto landmarks = landmarks_of_yard(1.0);
  for (WindowLandmark& landmark : landmarks) {
    Eigen::Vector3d& p = landmark.p_map;
    if (std::abs(p.x()) < 9.5) continue;
    const int place = static_cast<int>(std::floor((p.y() + 10.0) / kObject_m));
    const auto object = static_cast<unsigned>(2 * place + (p.x() > 0.0 ? 1 : 0));
    if (random.uniform(2 * object) > share) continue;
    p.x() += 1.2 * (random.uniform(2 * object + 1) - 0.5);
  }
  return landmarks;
}

Eigen::Vector2d sigmas_m(const ShiftProfile& profile) {
  return profile.excess().diagonal().cwiseSqrt();
}

TEST(ShiftProfile, HasNothingInExcessWhereTheWindowFitsNowhereNear) {
  const Eigen::Vector2d sigmas = sigmas_m(profile_of(landmarks_of_yard(1.0), yard()));
  EXPECT_LT(sigmas.maxCoeff(), 0.01);
}

TEST(ShiftProfile, IsWideAlongTheAxisOnWhichMostHasChanged) {
  const LaserMap map = yard();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Eigen::Vector2d sigmas = sigmas_m(profile_of(changed_across_x(0.9, seed), map));
    std::cout << "seed " << seed << ": excess " << sigmas.transpose() << " m\n";
    EXPECT_GT(sigmas.x(), 0.03) << "seed " << seed;
    EXPECT_LT(sigmas.y(), 0.01) << "seed " << seed;
  }
}

// A place beside the right one that matches by chance: the right one stays within its three sigmas.
TEST(ShiftProfile, LeavesRoomForTheRightPlaceAtAWrongOne) {
  const LaserMap map = yard();
  const Eigen::Vector3d error(0.3, 0.0, 0.0);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto there = moved(changed_across_x(0.7, seed), error);
    const Eigen::Vector2d sigmas = sigmas_m(profile_of(there, map));
    EXPECT_GT(3.0 * sigmas.x(), error.x()) << "seed " << seed;
  }
}

double information_along(const std::vector<MapMatch>& matches, const Eigen::Vector3d& axis) {
  double sum = 0.0;
  for (const MapMatch& match : matches) {
    const double n = match.normal.dot(axis);
    const double own = match.normal.dot(match.landmark.covariance * match.normal);
    const double sigma = match.sigma_m * match.widening;
    if (!match.is_level) sum += n * n / (sigma * sigma + own);
  }
  return sum;
}

TEST(ShiftProfile, WidensTheMatchesAlongThatAxisAlone) {
  const LaserMap map = yard();
  const auto config = localizer_config().registration;
  auto landmarks = changed_across_x(0.9, 1);
  const ShiftProfile profile = profile_of(landmarks, map);
  for (WindowLandmark& landmark : landmarks) landmark.covariance *= 1e-6;
  auto matches = associate(landmarks, map, config.rounds.final_gate_m, config.association).matches;
  const double x_before = information_along(matches, Eigen::Vector3d::UnitX());
  const double y_before = information_along(matches, Eigen::Vector3d::UnitY());
  profile.widen(matches);
  // The variance of the shift is now that of the matches and the excess.
  const double x_after = 1.0 / (1.0 / x_before + profile.excess()(0, 0));
  EXPECT_NEAR(information_along(matches, Eigen::Vector3d::UnitX()), x_after, 0.02 * x_before);
  EXPECT_NEAR(information_along(matches, Eigen::Vector3d::UnitY()), y_before, 0.02 * y_before);
}

/// Where the observations and a match with a plane have brought a landmark: the optimum.
Eigen::Vector3d optimum(const Eigen::Vector3d& seen, const MapMatch& match) {
  const Eigen::Matrix3d own = match.landmark.covariance.inverse();
  const Eigen::Matrix3d map = match.normal * match.normal.transpose() / std::pow(match.sigma_m, 2);
  return (own + map).inverse() * (own * seen + map * match.q_map);
}

MapMatch match_of_a_distant_landmark() {
  MapMatch match;
  match.landmark.covariance = Eigen::Vector3d(0.09, 4e-4, 4e-4).asDiagonal();
  match.q_map = {10.0, 1.0, 2.0};
  match.normal = Eigen::Vector3d(-1.0, 0.2, 0.1).normalized();
  match.is_planar = true;
  match.sigma_m = 0.03;
  return match;
}

TEST(SeenWithoutMap, TakesBackWhatTheMatchHasDrawnALandmarkBy) {
  const Eigen::Vector3d seen(10.2, 1.05, 2.0);
  MapMatch match = match_of_a_distant_landmark();
  match.landmark.p_map = optimum(seen, match);
  EXPECT_GT((match.landmark.p_map - seen).norm(), 0.15);
  constexpr double kNoKernel = 1e6;
  const auto freed = seen_without_map({match.landmark}, {match}, kNoKernel);
  ASSERT_EQ(freed.size(), 1U);
  EXPECT_LT((freed.front().p_map - seen).norm(), 1e-6);
}

TEST(SeenWithoutMap, LeavesOutWhatIsOnLevelGroundAndKeepsWhatHasNoMatch) {
  MapMatch level = match_of_a_distant_landmark();
  level.landmark.id = LandmarkId{1};
  level.is_level = true;
  WindowLandmark unmatched;
  unmatched.id = LandmarkId{2};
  unmatched.p_map = {1.0, 2.0, 3.0};
  const auto freed = seen_without_map({level.landmark, unmatched}, {level}, 2.0);
  ASSERT_EQ(freed.size(), 1U);
  EXPECT_EQ(freed.front().id, LandmarkId{2});
  EXPECT_EQ(freed.front().p_map, unmatched.p_map);
}

}  // namespace
}  // namespace fleetloc
