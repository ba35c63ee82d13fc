// From an interruption of the odometry to the first answer of the session that follows.
#include <gtest/gtest.h>

#include "robot/fusion/pose_fusion.hpp"
#include "test/unit/fusion/either_fusion.hpp"
#include "test/unit/fusion/fed_fusion.hpp"

namespace fleetloc {
namespace {

TEST(PoseFusion, IsNotLocalizedFromAnInterruptionOnUntilAnAnswerOfTheNewSessionAgrees) {
  FedFusion fed;
  fed.drive_to(3.0);
  fed.answer_at(2.8);
  fed.drive_to(3.1);
  EXPECT_EQ(fed.output.quality, Quality::kLocalized);
  fed.fusion.interrupt();
  fed.drive_to(3.5, false);
  EXPECT_EQ(fed.output.quality, Quality::kDeadReckoning);
  EXPECT_LT(distance(*fed.output.T_map_body, true_T_map_odom() * fed.drive.pose(3.5)), 0.02);
  fed.drive_to(5.0, false);
  EXPECT_EQ(fed.output.quality, Quality::kLost);

  MapOdomEstimate carried{true_T_map_odom(), 1e-2 * Matrix6d::Identity()};
  carried.T_map_odom.p.x() += 0.1;
  fed.fusion.reset(SessionNumber{2}, carried);
  fed.drive_to(6.0);
  EXPECT_EQ(fed.output.quality, Quality::kDeadReckoning);
  EXPECT_NEAR(distance(*fed.output.T_map_body, true_T_map_odom() * fed.drive.pose(6.0)), 0.1, 0.02);
  EXPECT_GT((fed.output.covariance_map.bottomRightCorner<3, 3>().trace()), 2e-2);

  LocalizationResult fresh = answer(5.8, true_T_map_odom() * fed.drive.pose(5.8));
  EXPECT_EQ(name(fed.fusion.add_answer(fresh)), "wrong_session");
  fresh.session = SessionNumber{2};
  EXPECT_EQ(name(fed.fusion.add_answer(fresh)), "applied");
  fed.drive_to(6.1);
  EXPECT_EQ(fed.output.quality, Quality::kLocalized);
  // The answer takes the place of what was carried; it is not averaged with it.
  EXPECT_LT(distance(*fed.output.T_map_body, true_T_map_odom() * fed.drive.pose(6.1)), 5e-3);
}

TEST(PoseFusion, GatesTheFirstAnswerAfterAResetAgainstWhatWasCarried) {
  FedFusion fed;
  fed.drive_to(3.0);
  fed.answer_at(2.8);
  fed.fusion.reset(SessionNumber{2},
                   MapOdomEstimate{true_T_map_odom(), 1e-2 * Matrix6d::Identity()});
  fed.drive_to(6.0);
  Pose elsewhere = true_T_map_odom();
  elsewhere.p.y() += 2.0;
  LocalizationResult wrong = answer(5.8, elsewhere * fed.drive.pose(5.8));
  wrong.session = SessionNumber{2};
  EXPECT_EQ(name(fed.fusion.add_answer(wrong)), "gated");
  LocalizationResult other_map = answer(5.9, true_T_map_odom() * fed.drive.pose(5.9));
  other_map.session = SessionNumber{2};
  other_map.map_hash.front() ^= 1;
  EXPECT_EQ(name(fed.fusion.add_answer(other_map)), "wrong_map");
  fed.drive_to(6.1);
  EXPECT_EQ(fed.output.quality, Quality::kDeadReckoning);
}

TEST(PoseFusion, KnowsAfterAResetThatTheMapIsLevelAboutTheRobot) {
  FedFusion fed;
  fed.drive_to(3.0);
  fed.answer_at(2.8);
  MapOdomEstimate carried{{exp_so3({0.0, 0.0, 0.8}), {10.0, -4.0, 1.5}},
                          1e-8 * Matrix6d::Identity()};
  carried.p_odom = {300.0, 200.0, 0.0};
  fed.fusion.reset(SessionNumber{2}, carried);
  const MapOdomEstimate start = *fed.fusion.session_start();
  const double tilt = fusion_config().answers.map_tilt;
  EXPECT_NEAR(std::sqrt(start.covariance(0, 0)), tilt, 0.01 * tilt);
  EXPECT_NEAR(std::sqrt(start.covariance(1, 1)), tilt, 0.01 * tilt);
  EXPECT_LT(std::sqrt(start.covariance(2, 2)), 2e-4);
  const Matrix6d A = adjoint({Eigen::Quaterniond::Identity(), -carried.p_odom});
  const Matrix6d at_robot = A * start.covariance * A.transpose();
  EXPECT_LT((std::sqrt(at_robot.bottomRightCorner<3, 3>().trace())), 0.07);
}

TEST(PoseFusion, CarriesNothingOverAResetIfNoAnswerEverCame) {
  FedFusion fed;
  fed.drive_to(3.0);
  fed.fusion.reset(SessionNumber{2}, MapOdomEstimate{true_T_map_odom(), Matrix6d::Identity()});
  fed.drive_to(4.0);
  EXPECT_EQ(fed.output.quality, Quality::kSearching);
  EXPECT_FALSE(fed.output.T_map_body.has_value());
}

}  // namespace
}  // namespace fleetloc
