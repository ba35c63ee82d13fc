#include "deploy/sim/motion/spline_motion.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "deploy/sim/motion/motion_extremes.hpp"
#include "deploy/sim/motion/vibration.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

/// Turns over more than once about a moving axis, which angles would not survive.
Pose tumbling(double t) {
  return {.R = exp_so3({1.3 * t, 0.4 * std::sin(t), 0.0}) * exp_so3({0.0, 0.9 * t, 0.2 * t * t}),
          .p = {std::cos(t), 2.0 * std::sin(0.7 * t), 0.1 * t * t}};
}

SplineMotion tumbling_motion() {
  return spline_through(grid_over(8.0, 0.05), tumbling);
}

void expect_derivatives(const SplineMotion& motion, double time_s) {
  constexpr double kStep = 1e-5;
  const MotionState before = motion.at(time_s - kStep);
  const MotionState here = motion.at(time_s);
  const MotionState after = motion.at(time_s + kStep);
  const Eigen::Vector3d v = (after.T_map_body.p - before.T_map_body.p) / (2.0 * kStep);
  const Eigen::Vector3d a = (after.v_map - before.v_map) / (2.0 * kStep);
  const Eigen::Vector3d rate =
      log_so3(before.T_map_body.R.conjugate() * after.T_map_body.R) / (2.0 * kStep);
  const Eigen::Vector3d angular =
      (after.angular_velocity - before.angular_velocity) / (2.0 * kStep);
  EXPECT_LT((v - here.v_map).norm(), 1e-8) << time_s;
  EXPECT_LT((a - here.a_map).norm(), 1e-6) << time_s;
  EXPECT_LT((rate - here.angular_velocity).norm(), 1e-6) << time_s;
  EXPECT_LT((angular - here.angular_acceleration).norm(), 1e-5) << time_s;
}

TEST(SplineMotion, DerivativesMatchDifferences) {
  const SplineMotion motion = tumbling_motion();
  for (int i = 0; i < 50; ++i) expect_derivatives(motion, 0.1 + 0.157 * i);
}

TEST(SplineMotion, DerivativesMatchDifferencesAcrossKnots) {
  const SplineMotion motion = tumbling_motion();
  for (const double knot_s : {0.05, 1.0, 4.25}) expect_derivatives(motion, knot_s);
}

TEST(SplineMotion, PassesThroughThePosesItIsMadeOf) {
  const SplineMotion motion = tumbling_motion();
  for (int i = 0; i < 80; ++i) {
    const double time_s = 0.1 * i + 0.013;
    const Pose T = motion.at(time_s).T_map_body;
    EXPECT_LT((T.p - tumbling(time_s).p).norm(), 1e-6) << time_s;
    EXPECT_LT(log_so3(T.R.conjugate() * tumbling(time_s).R).norm(), 1e-5) << time_s;
    EXPECT_NEAR(T.R.norm(), 1.0, 1e-14);
  }
}

TEST(SplineMotion, StaysAtItsEndsOutsideOfItsTime) {
  const SplineMotion motion = tumbling_motion();
  EXPECT_EQ(motion.at(-1.0).T_map_body.p, motion.at(0.0).T_map_body.p);
  EXPECT_EQ(motion.at(99.0).T_map_body.p, motion.at(motion.duration()).T_map_body.p);
}

TEST(SplineMotion, IsCarriedOverAPart) {
  const SplineMotion motion = tumbling_motion();
  const SplineMotion carried = motion.carried(2.0, 1.5);
  EXPECT_DOUBLE_EQ(carried.duration(), motion.duration() - 1.5);
  EXPECT_EQ(carried.at(1.99).T_map_body.p, motion.at(1.99).T_map_body.p);
  EXPECT_EQ(carried.at(2.0).T_map_body.p, motion.at(3.5).T_map_body.p);
  EXPECT_EQ(carried.at(3.0).a_map, motion.at(4.5).a_map);
  EXPECT_EQ(motion.carried(2.0, 1e6).duration(), 2.0) << "to its end";
}

TEST(SplineMotion, RestsBeforeItMovesAndThenGoesTheSameWay) {
  const SplineMotion motion = tumbling_motion();
  const SplineMotion rested = with_rest(motion, 2.0, 3.0);
  for (const double time_s : {0.0, 1.0, 1.9}) {
    const MotionState state = rested.at(time_s);
    EXPECT_LT(state.v_map.norm(), 1e-5);
    EXPECT_LT(state.a_map.norm(), 1e-3);
    EXPECT_LT(state.angular_velocity.norm(), 1e-5);
    EXPECT_LT((state.T_map_body.p - motion.at(0.0).T_map_body.p).norm(), 1e-6);
  }
  EXPECT_NEAR(rested.duration(), motion.duration() + 3.5, 0.06);
  const MotionState late = rested.at(8.5);
  EXPECT_LT((late.T_map_body.p - motion.at(5.0).T_map_body.p).norm(), 1e-6);
  EXPECT_LT((late.v_map - motion.at(5.0).v_map).norm(), 1e-4);
}

TEST(Vibration, ShakesInMotionAndNotAtRest) {
  const auto way = [](double t) {
    const double u = std::max(0.0, t - 2.0);
    return Pose{.R = Eigen::Quaterniond::Identity(), .p = {0.2 * u * u, 0.0, 1.0}};
  };
  const SplineMotion smooth = spline_through(grid_over(8.0, 0.05), way);
  const VibrationConfig config{.height_m = 0.005, .pitch_rad = 0.01, .roll_rad = 0.008};
  const SplineMotion shaken = with_vibration(smooth, config, Eigen::Vector3d::UnitX(), 1);
  EXPECT_LT(shaken.at(1.0).angular_velocity.norm(), 1e-4);
  EXPECT_LT(shaken.at(1.0).a_map.norm(), 1e-3);
  double height = 0.0;
  double pitch = 0.0;
  for (int i = 0; i < 400; ++i) {
    const Pose T = shaken.at(4.0 + 0.01 * i).T_map_body;
    height = std::max(height, std::abs(T.p.z() - 1.0));
    pitch = std::max(pitch, std::abs(log_so3(T.R).y()));
    EXPECT_LT(std::abs(log_so3(T.R).z()), 1e-3);  // the heading stays
  }
  EXPECT_GT(height, config.height_m);
  EXPECT_LT(height, 1.75 * config.height_m);
  EXPECT_GT(pitch, config.pitch_rad);
  EXPECT_LT(pitch, 1.75 * config.pitch_rad);
  expect_derivatives(shaken, 5.123);
}

TEST(Vibration, DependsOnItsSeedAlone) {
  const SplineMotion motion = tumbling_motion();
  const VibrationConfig config{.height_m = 0.005, .pitch_rad = 0.01, .roll_rad = 0.008};
  const auto height = [&](std::uint64_t seed) {
    return with_vibration(motion, config, Eigen::Vector3d::UnitX(), seed).at(4.0).T_map_body.p.z();
  };
  EXPECT_EQ(height(1), height(1));
  EXPECT_NE(height(1), height(2));
}

}  // namespace
}  // namespace fleetloc
