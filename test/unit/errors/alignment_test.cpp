#include "deploy/evaluation/errors/alignment.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "deploy/evaluation/errors/trajectory_error.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

/// A path in space, and the same seen from a frame that lies at T_truth_estimate.
std::vector<PosePair> displaced(const Pose& T_truth_estimate) {
  std::vector<PosePair> pairs;
  for (int i = 0; i < 40; ++i) {
    const double t = 0.1 * i;
    const Pose T_truth_body{.R = exp_so3({0.1 * t, 0.2, t}),
                            .p = {std::cos(t), 2.0 * std::sin(2.0 * t), 0.3 * t * t}};
    pairs.push_back({.stamp = Timestamp(std::chrono::milliseconds(i)),
                     .T_truth_body = T_truth_body,
                     .T_estimate_body = inverse(T_truth_estimate) * T_truth_body});
  }
  return pairs;
}

const Pose kTilted{.R = exp_so3({0.4, -1.2, 2.0}), .p = {5.0, -3.0, 0.5}};
const Pose kTurned{.R = exp_so3({0.0, 0.0, -2.5}), .p = {5.0, -3.0, 0.5}};

TEST(Alignment, FindsAnyRigidTransformWithSe3) {
  for (const Pose& T : {kTilted, kTurned, Pose{}}) {
    EXPECT_LT(local_coordinates(align(displaced(T), Alignment::kSe3), T).norm(), 1e-9);
  }
}

TEST(Alignment, FindsPositionAndHeadingWithYaw) {
  EXPECT_LT(local_coordinates(align(displaced(kTurned), Alignment::kYaw), kTurned).norm(), 1e-9);
  const Pose T = align(displaced(kTilted), Alignment::kYaw);
  EXPECT_TRUE((T.R * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitZ()));
}

TEST(Alignment, ChangesNothingWithNone) {
  EXPECT_EQ(local_coordinates(align(displaced(kTilted), Alignment::kNone), Pose{}).norm(), 0.0);
}

TEST(Alignment, IsBetterThanEveryNearbyTransform) {
  auto pairs = displaced(kTilted);
  for (std::size_t i = 0; i < pairs.size(); ++i) {  // what no transform explains
    const auto phase = static_cast<double>(i);
    pairs[i].T_estimate_body.p +=
        0.1 * Eigen::Vector3d(std::sin(7.0 * phase), std::cos(phase), 0.1);
  }
  const auto rmse = [&pairs](const Pose& T) {
    return absolute_trajectory_error(pairs, T).translation_m.rmse;
  };
  for (const Alignment alignment : {Alignment::kSe3, Alignment::kYaw}) {
    const Pose best = align(pairs, alignment);
    for (int direction = alignment == Alignment::kSe3 ? 0 : 2; direction < 6; ++direction) {
      for (const double step : {1e-3, -1e-3}) {
        EXPECT_LT(rmse(best), rmse(retract(best, step * Vector6d::Unit(direction))));
      }
    }
  }
}

TEST(Alignment, IsARotationEvenIfPositionsAreMirrored) {
  auto pairs = displaced(Pose{});
  for (PosePair& pair : pairs) pair.T_estimate_body.p.x() *= -1.0;
  EXPECT_NEAR(align(pairs, Alignment::kSe3).R.norm(), 1.0, 1e-12);
}

TEST(FirstAlignment, MatchesPositionAndHeadingOfTheFirstPairAndKeepsItsTilt) {
  auto pairs = displaced(kTurned);
  EXPECT_LT(local_coordinates(align_first(pairs), kTurned).norm(), 1e-9);

  const Eigen::Quaterniond tilt = exp_so3({0.02, -0.03, 0.0});
  pairs[0].T_estimate_body.R = tilt * pairs[0].T_estimate_body.R;
  const Pose T = align_first(pairs);
  EXPECT_LT((T * pairs[0].T_estimate_body.p - pairs[0].T_truth_body.p).norm(), 1e-12);
  EXPECT_TRUE((T.R * Eigen::Vector3d::UnitZ()).isApprox(Eigen::Vector3d::UnitZ()));
  EXPECT_LT(log_so3(T.R.inverse() * kTurned.R).norm(), 1e-3);
}

}  // namespace
}  // namespace fleetloc
