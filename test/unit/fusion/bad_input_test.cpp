// What fusion does not use, and why.
#include <limits>

#include "test/unit/fusion/either_fusion.hpp"

namespace fleetloc {
namespace {

class FusionOfBadInput : public EitherFusion {};

TEST_P(FusionOfBadInput, NamesEveryRefusal) {
  FedFusion fed(config());
  EXPECT_EQ(name(fed.answer_at(0.0)), "unknown_stamp");
  fed.drive_to(40.0);
  EXPECT_EQ(name(fed.answer_at(20.03)), "unknown_stamp");
  EXPECT_EQ(name(fed.answer_at(41.0)), "unknown_stamp");
  EXPECT_EQ(name(fed.answer_at(9.8)), "too_old");
  EXPECT_EQ(name(fed.answer_at(20.0)), "applied");
  EXPECT_EQ(name(fed.answer_at(20.0)), "duplicate");
  LocalizationResult bad = answer(21.0, true_T_map_odom() * fed.drive.pose(21.0));
  const auto verdict_on = [&](auto change) {
    LocalizationResult changed = bad;
    change(changed);
    return fed.fusion.add_answer(changed);
  };
  EXPECT_EQ(
      name(verdict_on([](LocalizationResult& a) { a.status = LocalizationStatus::kPoorFit; })),
      "not_localized");
  EXPECT_EQ(name(verdict_on([](LocalizationResult& a) { a.map_hash[3] = 1; })), "wrong_map");
  bad.stamp = at(22.0);
  bad.T_map_body = true_T_map_odom() * fed.drive.pose(22.0);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(name(verdict_on([](LocalizationResult& a) { a.T_map_body.p.x() = kNan; })),
            "not_finite");
  EXPECT_EQ(name(verdict_on([](LocalizationResult& a) { a.covariance(0, 0) = kNan; })),
            "not_finite");
  EXPECT_EQ(name(verdict_on([](LocalizationResult& a) { a.covariance(0, 0) = -1.0; })),
            "bad_covariance");
  EXPECT_EQ(name(verdict_on([](LocalizationResult& a) { a.covariance(0, 5) = 1e-6; })),
            "bad_covariance");
  EXPECT_EQ(name(verdict_on([](LocalizationResult& a) { a.T_map_body.p.x() += 2.0; })), "gated");
}

TEST_P(FusionOfBadInput, RefusesAnswersThatWouldTiltTheMap) {
  FedFusion fed(config());
  fed.drive_to(2.0);
  const Pose tilted{exp_so3({0.1, 0.0, 0.5}), Eigen::Vector3d::Zero()};
  EXPECT_EQ(name(fed.answer_at(1.0, tilted)), "implausible_tilt");
  EXPECT_FALSE(fed.fusion.session_start());
  EXPECT_TRUE(fed.answer_at(1.5).has_value());
}

TEST_P(FusionOfBadInput, ANewerRevisionReplacesTheAnswer) {
  FedFusion fed(config());
  FedFusion only_newer(config());
  fed.drive_to(3.0);
  only_newer.drive_to(3.0);
  LocalizationResult older = answer(2.0, moved(true_T_map_odom(), 0.1) * fed.drive.pose(2.0));
  LocalizationResult newer = answer(2.0, true_T_map_odom() * fed.drive.pose(2.0));
  newer.revision = Revision{1};
  EXPECT_TRUE(fed.fusion.add_answer(older).has_value());
  EXPECT_TRUE(fed.fusion.add_answer(newer).has_value());
  EXPECT_EQ(name(fed.fusion.add_answer(older)), "older_than_applied");
  only_newer.fusion.add_answer(newer);
  EXPECT_TRUE(identical(fed.fusion.session_start()->T_map_odom,
                        only_newer.fusion.session_start()->T_map_odom));
  EXPECT_EQ(fed.fusion.session_start()->covariance, only_newer.fusion.session_start()->covariance);
}

TEST_P(FusionOfBadInput, ResetForgetsTheOldSession) {
  FedFusion fed(config());
  fed.drive_to(3.0);
  fed.answer_at(2.0);
  fed.fusion.reset(SessionNumber{1}, std::nullopt);
  EXPECT_FALSE(fed.fusion.session_start());
  EXPECT_FALSE(fed.fusion.estimate_at(at(2.5)));
  EXPECT_EQ(name(fed.answer_at(2.5)), "wrong_session");
  fed.drive_to(3.01, /*with_odometry=*/false);
  EXPECT_EQ(fed.output.quality, Quality::kInitializing);
  fed.drive_to(4.0);
  LocalizationResult current = answer(3.5, true_T_map_odom() * fed.drive.pose(3.5));
  current.session = SessionNumber{1};
  EXPECT_TRUE(fed.fusion.add_answer(current).has_value());
}

TEST_P(FusionOfBadInput, SurvivesDoubledAndDisorderedSamples) {
  FedFusion clean(config());
  FedFusion disturbed(config());
  for (int i = 1; i <= 20; ++i) {
    clean.drive_to(0.1 * i);
    disturbed.drive_to(0.1 * i);
    const PoseEstimate doubled = disturbed.fusion.add_imu(disturbed.drive.imu(0.1 * i));
    const PoseEstimate older = disturbed.fusion.add_imu(disturbed.drive.imu(0.1 * i - 0.025));
    ImuSample broken = disturbed.drive.imu(0.1 * i + 0.001);
    broken.specific_force.x() = std::numeric_limits<double>::infinity();
    EXPECT_EQ(disturbed.fusion.add_imu(broken).stamp, clean.output.stamp);
    EXPECT_EQ(doubled.stamp, clean.output.stamp);
    EXPECT_TRUE(identical(older.T_odom_body, clean.output.T_odom_body));
  }
  disturbed.drive_to(3.0);
  clean.drive_to(3.0);
  EXPECT_TRUE(identical(disturbed.output.T_odom_body, clean.output.T_odom_body));
}

TEST_P(FusionOfBadInput, RefusesOdometryThatItCannotUse) {
  FedFusion fed(config());
  fed.drive_to(40.0);
  const auto verdict_at = [&](double t) {
    return fed.fusion.add_odometry(odometry(t, fed.drive.state(t)));
  };
  EXPECT_EQ(verdict_at(39.9).error(), FusionRejection::kOlderThanApplied);
  fed.fusion.reset(SessionNumber{1}, std::nullopt);
  EXPECT_EQ(verdict_at(5.0).error(), FusionRejection::kBeforeImu);
  OdometryEstimate broken = odometry(39.9, fed.drive.state(39.9));
  broken.state.v_odom.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fed.fusion.add_odometry(broken).error(), FusionRejection::kNotFinite);
  EXPECT_TRUE(verdict_at(39.9).has_value());
}

INSTANTIATE_TEST_SUITE_P(Fusion,
                         FusionOfBadInput,
                         testing::Values(PoseFusion::Formulation::kDecoupled,
                                         PoseFusion::Formulation::kCoupled),
                         kFormulation);

}  // namespace
}  // namespace fleetloc
