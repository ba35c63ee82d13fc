#include "cloud/localizer/dead_reckoning.hpp"

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

const Pose kPose{exp_so3({0.3, -0.5, 2.0}), {1.0, -2.0, 0.5}};
constexpr DriftConfig kDrift{.translation_m_per_m = 0.02, .rotation_rad_per_m = 0.004};

KeyframeId keyframe_at(int x) {
  return KeyframeId{static_cast<std::uint32_t>(x)};
}

// One keyframe a metre along x of odom, which begins at 100 m; the start pose is known there.
class Drive {
 public:
  void to(int x) {
    for (; next_ <= x; ++next_) {
      Submap submap;
      SubmapKeyframe keyframe;
      keyframe.id = keyframe_at(next_);
      keyframe.T_odom_body.p.x() = 100.0 + next_;
      submap.keyframes.push_back(keyframe);
      VirtualEdge edge;
      edge.from = keyframe_at(next_ - 1);
      edge.to = keyframe.id;
      if (next_ > 0) submap.edges.push_back(edge);
      database.add(submap);
      reckoning.follow(database.keyframes());
    }
  }
  static MapOdomEstimate start() {
    return {.T_map_odom = Pose{exp_so3({0.0, 0.0, 1.0}), {5.0, 6.0, 7.0}},
            .covariance = 0.01 * Matrix6d::Identity(),
            .p_odom = {100.0, 0.0, 0.0}};
  }

  SessionDatabase database{{.window = 40}};
  DeadReckoning reckoning{start(), kDrift};

 private:
  int next_ = 0;
};

TEST(PoseAnchor, LosesItsWayWithThePathAndNotOnlyWithTheDistanceFromWhereItWas) {
  const PoseAnchor anchor{.keyframe = std::nullopt,
                          .T_odom_body = kPose,
                          .travelled_m = 10.0,
                          .estimate = {kPose, 1e-6 * Matrix6d::Identity()}};
  const Matrix6d still = anchor.at(kPose, 10.0, kDrift).covariance;
  const Matrix6d looped = anchor.at(kPose, 60.0, kDrift).covariance;
  EXPECT_LT(still(5, 5), 1e-5);
  EXPECT_NEAR(looped(5, 5), 1.0, 1e-3);
  EXPECT_NEAR(looped(0, 0), 0.04, 1e-3);
}

TEST(DeadReckoning, HasNoAnchorWithoutAStartPose) {
  const DeadReckoning reckoning(std::nullopt, kDrift);
  EXPECT_FALSE(reckoning.has_anchor());
  EXPECT_FALSE(reckoning.is_localized());
}

TEST(DeadReckoning, BeginsWithTheFirstKeyframesAlsoIfItHasTakenOverNone) {
  Drive drive;
  drive.reckoning.follow({});
  drive.to(20);
  EXPECT_NEAR(drive.reckoning.travelled_m(keyframe_at(20)), 20.0, 1e-9);
}

TEST(DeadReckoning, FollowsTheOdometryFromTheStartPose) {
  Drive drive;
  drive.to(20);
  EXPECT_TRUE(drive.reckoning.has_anchor());
  EXPECT_FALSE(drive.reckoning.is_localized());
  EXPECT_DOUBLE_EQ(drive.reckoning.travelled_m(keyframe_at(20)), 20.0);
  const SubmapKeyframe& newest = drive.database.newest().item;
  const PoseWithCovariance there = drive.reckoning.at(newest);
  const Pose expected = Drive::start().T_map_odom * newest.T_odom_body;
  EXPECT_LT(local_coordinates(there.T_map_body, expected).norm(), 1e-9);
  // 0.1 m of the start, and 2 % and 0.1 rad over 20 m.
  EXPECT_NEAR(there.covariance(3, 3), 0.01 + 0.4 * 0.4, 1e-6);
  EXPECT_GT(there.covariance(4, 4), 4.0);
}

TEST(DeadReckoning, HoldsTheWindowWhereItWasLocalizedLast) {
  Drive drive;
  drive.to(10);
  EXPECT_EQ(drive.reckoning.prior(drive.database.window(), drive.database).keyframe,
            keyframe_at(0));
  const PoseWithCovariance found{kPose, 1e-4 * Matrix6d::Identity()};
  drive.reckoning.restart(drive.database.newest().item, found);
  EXPECT_TRUE(drive.reckoning.is_localized());

  drive.to(49);  // the window begins at keyframe 10
  const PosePrior inside = drive.reckoning.prior(drive.database.window(), drive.database);
  EXPECT_EQ(inside.keyframe, keyframe_at(10));
  EXPECT_EQ(inside.estimate.covariance, found.covariance);

  drive.to(51);
  const PosePrior outside = drive.reckoning.prior(drive.database.window(), drive.database);
  EXPECT_EQ(outside.keyframe, keyframe_at(12));
  EXPECT_NEAR((outside.estimate.T_map_body.p - kPose.p).norm(), 2.0, 1e-9);
  EXPECT_GT(outside.estimate.covariance(3, 3), found.covariance(3, 3));
}

// Its newest answers come from keyframes that are still in the window: they are not data beside it.
TEST(DeadReckoning, KnowsBeforeAWindowWhatItsOldestKeyframeWasAnsweredWhenItWasTheNewest) {
  Drive drive;
  const auto before = [&] {
    return drive.reckoning.before(drive.database.window(), drive.database);
  };
  const auto answered = [](int x) {
    return PoseWithCovariance{Pose{kPose.R, {1.0 * x, 0.0, 0.0}},
                              (1e-4 + 1e-6 * x) * Matrix6d::Identity()};
  };
  drive.to(10);
  EXPECT_EQ(before().keyframe, keyframe_at(0));
  const Matrix6d start = before().estimate.covariance;
  for (int x = 10; x <= 60; ++x) {
    drive.to(x);
    if (x <= 49) {
      EXPECT_GE(before().estimate.covariance(5, 5), start(5, 5)) << x;
    }
    if (x % 3 != 0) continue;
    drive.reckoning.restart(drive.database.newest().item, answered(x + 1));
    drive.reckoning.restart(drive.database.newest().item, answered(x));  // the later one counts
  }
  // The window begins at 21, which had an answer of its own.
  EXPECT_EQ(before().keyframe, keyframe_at(21));
  EXPECT_EQ(before().estimate.covariance, answered(21).covariance);
  EXPECT_EQ(before().estimate.T_map_body.p, answered(21).T_map_body.p);
  EXPECT_GT(start(5, 5), answered(21).covariance(5, 5));
  drive.to(62);  // at 23: two metres on from there
  EXPECT_EQ(before().keyframe, keyframe_at(23));
  EXPECT_NEAR((before().estimate.T_map_body.p - answered(21).T_map_body.p).norm(), 2.0, 1e-9);
  EXPECT_GT(before().estimate.covariance(3, 3), answered(21).covariance(3, 3) + 0.0015);
}

// It brings keyframes of the way that it has come; where it is now is known best.
TEST(DeadReckoning, HoldsARobotThatComesFromAnotherLocalizerAtItsNewestKeyframe) {
  constexpr int kAll = 30;
  SessionDatabase database{{.window = 40}};
  MapOdomEstimate start = Drive::start();
  start.covariance = 1e-4 * Matrix6d::Identity();
  start.p_odom.x() = 100.0 + kAll;
  DeadReckoning reckoning(start, kDrift);
  std::vector<KeyframeId> window;
  for (const auto& [from, to] : {std::pair(20, kAll), std::pair(0, 20)}) {  // the newest ones first
    Submap submap;
    for (int x = from; x <= to; ++x) {
      SubmapKeyframe keyframe;
      keyframe.id = keyframe_at(x);
      keyframe.T_odom_body.p.x() = 100.0 + x;
      submap.keyframes.push_back(keyframe);
    }
    database.add(submap);
    reckoning.follow(database.keyframes());
  }
  for (int x = 0; x <= kAll; ++x) window.push_back(keyframe_at(x));
  const PosePrior prior = reckoning.prior(window, database);
  EXPECT_EQ(prior.keyframe, keyframe_at(kAll));
  const PoseWithCovariance newest = reckoning.at(database.keyframe(keyframe_at(kAll)).item);
  EXPECT_LT(newest.covariance(3, 3), 1.1e-4) << "no drift since";
  const PoseWithCovariance oldest = reckoning.at(database.keyframe(keyframe_at(0)).item);
  EXPECT_NEAR(std::sqrt(oldest.covariance(3, 3)), 0.02 * kAll, 0.02);
  EXPECT_NEAR(reckoning.travelled_m(keyframe_at(0)), -kAll, 1e-6);
}

}  // namespace
}  // namespace fleetloc
