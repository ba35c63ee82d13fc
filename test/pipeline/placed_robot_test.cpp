// A robot that somebody tells where it is, while it is on its way: it is localized from there, with
// the keyframes that it has, whatever it believed before.
#include <algorithm>
#include <iostream>
#include <optional>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"
#include "test/pipeline/simulated_system.hpp"

namespace fleetloc {
namespace {

constexpr double kStandsAt = 40.0;  // [s]

class PlacedRobot : public testing::Test {
 protected:
  static SimulatedRun flight() {
    SimulatedRun::Config config = noisy_flight();
    config.imu_rate_hz = 100.0;
    config.frame_rate_hz = 10.0;
    config.stop = {.at_s = kStandsAt, .stands_s = 60.0};
    return SimulatedRun(config);
  }
  void begin(const std::optional<Pose>& T_map_body_start) {
    system_.emplace(run_, map_of(run_), perfect_link(), T_map_body_start);
  }

  [[nodiscard]] Pose truth(double t) const { return run_.truth(at(t)).T_odom_body; }

  /// Beside the truth, in the axes of the map.
  [[nodiscard]] Pose displaced(double t, double x, double yaw_deg) const {
    const double yaw = yaw_deg * M_PI / 180.0;
    const Pose T_map_body = truth(t);
    return {exp_so3({0.0, 0.0, yaw}) * T_map_body.R, T_map_body.p + Eigen::Vector3d(x, -x, 0.0)};
  }

  void place(double t, double x, double yaw_deg) {
    system_->robot().place({.stamp = at(t), .T_map_body = displaced(t, x, yaw_deg)});
  }

  /// When a frame is localized from `since` on; the worst error of the localized ones from then on.
  struct Found {
    std::optional<double> at_s;
    double worst_m = 0.0;
  };
  [[nodiscard]] Found found_since(double since) const {
    Found found;
    for (const FrameOutput& frame : system_->robot().frames) {
      const double t = to_seconds(frame.stamp.time_since_epoch());
      if (t < since || frame.pose.quality != Quality::kLocalized) continue;
      if (!found.at_s) found.at_s = t;
      const double error_m =
          (frame.pose.T_map_body->p - run_.truth(frame.stamp).T_odom_body.p).norm();
      found.worst_m = std::max(found.worst_m, error_m);
    }
    return found;
  }
  [[nodiscard]] Quality quality() const { return system_->robot().frames.back().pose.quality; }

  static Timestamp at(double t) { return Timestamp{from_seconds(t)}; }

  SimulatedRun run_ = flight();
  std::optional<SimulatedSystem> system_;
};

TEST_F(PlacedRobot, ThatKnewNothingIsLocalizedWithinSecondsByTheKeyframesThatItHas) {
  begin(std::nullopt);
  system_->play(20.0);
  EXPECT_EQ(quality(), Quality::kSearching);
  EXPECT_EQ(system_->robot().pipeline().faults().at("unknown_starts"), 1U);
  place(20.0, 0.3, 5.0);
  system_->play(30.0);
  const Found found = found_since(20.0);
  ASSERT_TRUE(found.at_s);
  EXPECT_LT(*found.at_s, 23.0);
  EXPECT_LT(found.worst_m, 0.1);
  std::cout << "localized after " << *found.at_s - 20.0 << " s, worst error " << found.worst_m
            << " m\n";
}

// As far beside as RViz' "2D Pose Estimate" says that it may be: 0.5 m and 15 degrees (one sigma).
TEST_F(PlacedRobot, IsFoundAsFarOffAsRvizAllows) {
  for (const double sign : {1.0, -1.0}) {
    begin(std::nullopt);
    system_->play(20.0);
    GivenPose given{.stamp = at(20.0), .T_map_body = displaced(20.0, 0.5 * sign, 15.0)};
    given.covariance.diagonal() << 0.0, 0.0, 0.0685, 0.25, 0.25, 0.0;  // of yaw, x and y
    const Eigen::Matrix3d R = given.T_map_body.R.toRotationMatrix();
    for (const int block : {0, 3}) {
      const Eigen::Matrix3d along_map = given.covariance.block<3, 3>(block, block);
      given.covariance.block<3, 3>(block, block) = R.transpose() * along_map * R;
    }
    system_->robot().place(given);
    system_->play(30.0);
    const Found found = found_since(20.05);
    ASSERT_TRUE(found.at_s) << sign;
    EXPECT_LT(*found.at_s, 25.0);
    EXPECT_LT(found.worst_m, 0.1);
    std::cout << "localized after " << *found.at_s - 20.0 << " s, worst error " << found.worst_m
              << " m\n";
  }
}

// Starts seven sigmas beside the truth: the room has other places that fit what is seen at first.
TEST_F(PlacedRobot, IsNeverSureOfAPlaceMetresBesideAndIsFoundOncePlaced) {
  for (const Eigen::Vector3d& beside :
       {Eigen::Vector3d(3.5, 0.0, 0.0), Eigen::Vector3d(4.0, 2.0, 0.0)}) {
    begin(Pose{truth(0.0).R, truth(0.0).p + beside});
    system_->play(15.0);
    if (quality() == Quality::kLocalized) {
      EXPECT_LT(found_since(14.0).worst_m, 0.1) << beside.transpose();
    }
    place(15.0, 0.3, -5.0);
    system_->play(25.0);
    const Found found = found_since(15.05);
    ASSERT_TRUE(found.at_s) << beside.transpose();
    EXPECT_LT(*found.at_s, 18.0);
    EXPECT_LT(found.worst_m, 0.1);
  }
}

TEST_F(PlacedRobot, HasNoMapPoseUntilALocalizerConfirmsIt) {
  begin(truth(0.0));
  system_->play(15.0);
  ASSERT_EQ(quality(), Quality::kLocalized);
  place(15.0, 4.0, 60.0);  // it is not there
  system_->play(15.2);
  EXPECT_EQ(quality(), Quality::kSearching);
  EXPECT_FALSE(system_->robot().frames.back().pose.T_map_body);
  system_->play(25.0);
  EXPECT_LT(found_since(15.2).worst_m, 0.1) << "a person's mistake makes no wrong pose";
  place(25.0, 0.2, 3.0);
  system_->play(35.0);
  EXPECT_TRUE(found_since(25.0).at_s);
  EXPECT_LT(found_since(25.0).worst_m, 0.1);
}

TEST_F(PlacedRobot, IsFoundWhereItStands) {
  begin(truth(0.0));
  system_->play(kStandsAt + 5.0);
  ASSERT_EQ(quality(), Quality::kLocalized);
  const double now = kStandsAt + 5.0;
  place(now, 0.3, 5.0);
  system_->play(now + 20.0);
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_LT(found_since(now + 0.05).worst_m, 0.1);
}

}  // namespace
}  // namespace fleetloc
