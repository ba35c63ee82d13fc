#include "robot/odometry/standstill.hpp"

#include <functional>

#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "shared/core/counter_random.hpp"
#include "shared/geometry/so3.hpp"
#include "test/simulated_setup.hpp"

namespace fleetloc {
namespace {

/// A body, its IMU at 200 Hz and its odometry at 10 Hz.
class Standstill : public testing::Test {
 protected:
  /// @param motion  changes what the IMU reads, the pose, or whether it is seen
  void play(double seconds, const std::function<void(double t)>& motion = {}) {
    const int until = sample_ + static_cast<int>(200.0 * seconds);
    for (; sample_ < until; ++sample_) {
      const double t = sample_ / 200.0;
      if (motion) motion(t);
      const Timestamp stamp{from_seconds(t)};
      const auto index = static_cast<std::uint64_t>(sample_);
      detector_.add_imu({stamp,
                         bias_ + turn_rate_ + 0.005 * gyroscope_.normal3(index),
                         gravity_ + force_ + 0.05 * accelerometer_.normal3(index)});
      if (sample_ % 20 == 0) since_ = detector_.update(stamp, pose_, is_seen_);
    }
  }
  [[nodiscard]] bool stands() const { return since_.has_value(); }

  StandstillDetector detector_{read_standstill_config(defaults().section("standstill"))};
  Eigen::Vector3d bias_{0.02, -0.03, 0.01};
  Eigen::Vector3d gravity_{0.3, 9.7, 0.8};
  Eigen::Vector3d turn_rate_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  Pose pose_{Eigen::Quaterniond::Identity(), {4.0, 5.0, 6.0}};
  bool is_seen_ = true;
  CounterRandom gyroscope_{1, 1};
  CounterRandom accelerometer_{1, 2};
  int sample_ = 0;
  std::optional<Timestamp> since_;
};

TEST_F(Standstill, IsFoundAfterTwoSecondsAndLasts) {
  play(1.9);
  EXPECT_FALSE(stands());
  play(1.0);
  EXPECT_TRUE(stands());
  int moved = 0;
  play(3600.0, [&](double) { moved += stands() ? 0 : 1; });
  EXPECT_EQ(moved, 0);
}

TEST_F(Standstill, IsNotAnEvenMotion) {
  play(20.0, [this](double t) { pose_.p.x() = 0.05 * t; });
  EXPECT_FALSE(stands()) << "0.05 m/s, which no IMU feels";
}

TEST_F(Standstill, EndsWhenThePoseMoves) {
  play(10.0);
  const double begin = sample_ / 200.0;
  play(0.6, [&](double t) { pose_.p.x() = 4.0 + 0.05 * (t - begin); });
  EXPECT_FALSE(stands()) << "0.02 m after 0.4 s";
}

TEST_F(Standstill, EndsInTheDarkWithTheFirstPushOrTurn) {
  is_seen_ = true;
  play(10.0);
  is_seen_ = false;
  const double begin = sample_ / 200.0;
  play(10.0, [&](double t) { pose_.p.x() = 4.0 + 0.5 * (t - begin); });
  EXPECT_TRUE(stands()) << "what inertial prediction says in the dark counts for nothing";
  force_.z() = 0.3;
  play(0.3);
  EXPECT_FALSE(stands());
  force_.setZero();
  is_seen_ = true;
  play(10.0);
  EXPECT_TRUE(stands());
  is_seen_ = false;
  turn_rate_.y() = 0.02;
  play(0.3);
  EXPECT_FALSE(stands());
}

TEST_F(Standstill, GoesOnWhileAnEngineRuns) {
  play(60.0, [this](double t) { force_.y() = std::sin(2.0 * M_PI * 25.0 * t); });
  EXPECT_TRUE(stands());
}

// By 1 mg and 0.1 degrees a second in five minutes.
TEST_F(Standstill, GoesOnWhileBiasesWalk) {
  play(10.0);
  int moved = 0;
  play(300.0, [&](double t) {
    force_.x() = 0.01 * (t - 10.0) / 300.0;
    turn_rate_.x() = 0.0017 * (t - 10.0) / 300.0;
    moved += stands() ? 0 : 1;
  });
  EXPECT_EQ(moved, 0);
}

TEST_F(Standstill, BeginsAnewAfterAReset) {
  play(10.0);
  detector_.reset();
  play(1.0);
  EXPECT_FALSE(stands());
  play(2.0);
  EXPECT_TRUE(stands());
}

}  // namespace
}  // namespace fleetloc
