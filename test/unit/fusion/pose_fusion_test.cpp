#include "robot/fusion/pose_fusion.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "shared/geometry/covariance.hpp"
#include "test/unit/fusion/either_fusion.hpp"

namespace fleetloc {
namespace {

TEST_P(EitherFusion, PredictsFromALateStateToTheNewestSample) {
  FedFusion fed(config());
  fed.drive_to(2.03);
  EXPECT_EQ(fed.output.stamp, at(2.03));
  EXPECT_LT(distance(fed.output.T_odom_body, fed.drive.pose(2.03)), 1e-6);
  EXPECT_LT((fed.output.v_odom - fed.drive.state(2.03).v_odom).norm(), 1e-5);
}

TEST_P(EitherFusion, GivesTheSameHoweverLateTheStateCame) {
  const CircularDrive drive;
  const auto fresh = make_pose_fusion(euroc_imu_noise(), config());
  const auto late = make_pose_fusion(euroc_imu_noise(), config());
  const OdometryEstimate state = odometry(0.0537, drive.state(0.0537));  // between two samples
  PoseEstimate a;
  PoseEstimate b;
  for (int i = 0; i <= 100; ++i) {
    if (i == 5) {
      fresh->add_odometry(state);  // ahead of the IMU
    }
    a = fresh->add_imu(drive.imu(0.01 * i));
    if (i == 100) {
      late->add_odometry(state);
    }
    b = late->add_imu(drive.imu(0.01 * i));
  }
  b = *late->estimate_at(at(1.0));
  EXPECT_EQ(a.stamp, b.stamp);
  EXPECT_TRUE(identical(a.T_odom_body, b.T_odom_body));
  EXPECT_EQ(a.covariance_odom, b.covariance_odom);
  EXPECT_LT(distance(a.T_odom_body, drive.pose(1.0)), 1e-5);
}

TEST_P(EitherFusion, AnswersDoNotTouchTheOdomPose) {
  FedFusion with(config());
  FedFusion without(config());
  for (int i = 1; i <= 40; ++i) {
    with.drive_to(0.5 * i);
    without.drive_to(0.5 * i);
    if (i > 4) {
      with.answer_at(0.5 * i - 1.0, moved(true_T_map_odom(), 0.01 * i));
    }
    EXPECT_TRUE(identical(with.output.T_odom_body, without.output.T_odom_body));
    EXPECT_EQ(with.output.covariance_odom, without.output.covariance_odom);
    EXPECT_EQ(with.output.v_odom, without.output.v_odom);
  }
}

TEST_P(EitherFusion, FirstAnswerPlacesTheRobotInTheMap) {
  FedFusion fed(config());
  fed.drive_to(3.0);
  EXPECT_FALSE(fed.output.T_map_body);
  EXPECT_FALSE(fed.fusion.session_start());
  EXPECT_EQ(name(fed.answer_at(1.0)), "applied");
  fed.drive_to(3.01);
  ASSERT_TRUE(fed.output.T_map_body);
  EXPECT_LT(distance(*fed.output.T_map_body, true_T_map_odom() * fed.drive.pose(3.01)),
            tolerance());
  EXPECT_EQ(fed.output.since_last_answer, at(3.01) - at(1.0));
}

TEST_P(EitherFusion, MapOdomEstimateIsTheAlignmentWithItsCovariance) {
  FedFusion fed(config());
  fed.drive_to(3.0);
  fed.answer_at(0.0);  // odom and body coincide there
  const auto start = fed.fusion.session_start();
  ASSERT_TRUE(start);
  EXPECT_LT(distance(start->T_map_odom, true_T_map_odom()), 0.5 * tolerance());
  const Matrix6d drift = start->covariance - answer_covariance();
  const double per_metre = std::pow(config().drift.translation, 2);
  EXPECT_GT(drift(5, 5), 0.8 * 3.0 * per_metre);  // 3 m of travel
  EXPECT_LT(start->covariance(5, 5), answer_covariance()(5, 5) + 1e-3);
}

TEST_P(EitherFusion, MapCovarianceGrowsWithTheDistanceSinceTheAnswer) {
  FedFusion fed(config());
  fed.drive_to(2.0);
  fed.answer_at(1.0);
  fed.drive_to(2.5);
  const double soon = fed.output.covariance_map.bottomRightCorner<3, 3>().trace();
  fed.drive_to(40.0);
  const double later = fed.output.covariance_map.bottomRightCorner<3, 3>().trace();
  EXPECT_GT(later, soon + 3 * std::pow(config().drift.translation, 2) * 37.0);
}

// Many answers from one place repeat the same error; on the way they are new ones.
TEST(PoseFusion, LearnsLittleFromRepeatedAnswersAtRest) {
  PoseFusion::Config config = fusion_config();
  config.drift = {.translation = 1e-6, .yaw = 1e-6, .yaw_by_rotation = 1e-6, .tilt = 1e-6};
  const auto variance_after_answers = [&config](double speed) {
    FedFusion fed(config);
    fed.drive.speed = speed;
    for (int i = 1; i < 100; ++i) {
      fed.drive_to(1.0 * i + 0.5);
      EXPECT_TRUE(fed.answer_at(1.0 * i).has_value());
    }
    return fed.output.covariance_map.bottomRightCorner<3, 3>().trace();
  };
  const double one_answer = answer_covariance().bottomRightCorner<3, 3>().trace();
  EXPECT_GT(variance_after_answers(0.0), 0.85 * one_answer);
  EXPECT_LT(variance_after_answers(1.0), 0.5 * one_answer);
}

TEST_P(EitherFusion, IsSearchingUntilThereIsAnAnswerHoweverLate) {
  FedFusion fed(config());
  EXPECT_EQ(fed.output.quality, Quality::kInitializing);
  fed.drive_to(0.04);
  EXPECT_EQ(fed.output.quality, Quality::kInitializing);
  fed.drive_to(12.5);
  EXPECT_EQ(fed.output.quality, Quality::kSearching);
  fed.answer_at(0.5);
  fed.drive_to(12.6);
  EXPECT_EQ(fed.output.quality, Quality::kLocalized);
  EXPECT_EQ(fed.output.since_last_answer, at(12.1) - at(0.0));
}

TEST_P(EitherFusion, ForgetsTheMapAndKeepsTheOdometry) {
  FedFusion fed(config());
  FedFusion other(config());
  for (FedFusion* each : {&fed, &other}) {
    each->drive_to(3.0);
    each->answer_at(1.0);
  }
  fed.fusion.forget_map(SessionNumber{9});
  for (FedFusion* each : {&fed, &other}) each->drive_to(3.01);
  EXPECT_TRUE(identical(fed.output.T_odom_body, other.output.T_odom_body));
  EXPECT_EQ(fed.output.covariance_odom, other.output.covariance_odom);
  EXPECT_FALSE(fed.output.T_map_body);
  EXPECT_FALSE(fed.fusion.session_start());
  EXPECT_EQ(fed.output.quality, Quality::kSearching);
  EXPECT_EQ(name(fed.answer_at(2.0)), "wrong_session");
  fed.session = SessionNumber{9};
  EXPECT_EQ(name(fed.answer_at(2.0)), "applied") << "to a frame before it";
  fed.drive_to(3.1);
  ASSERT_TRUE(fed.output.T_map_body);
  EXPECT_LT(distance(*fed.output.T_map_body, true_T_map_odom() * fed.drive.pose(3.1)), tolerance());
}

TEST_P(EitherFusion, IsLocalizedAsLongAsItsCovarianceIsSmall) {
  const auto sigma = [](const PoseEstimate& estimate, int row) {
    return max_sigma(estimate.covariance_map.block<3, 3>(row, row));
  };
  for (const bool position : {true, false}) {
    PoseFusion::Config limited = config();
    limited.localized_for_s = 1000.0;
    limited.localized_below_m = position ? 0.06 : 1.0;
    limited.localized_below_rad = position ? 1.0 : 0.0062;
    FedFusion fed(limited);
    fed.drive_to(2.0);
    fed.answer_at(1.0);
    int localized = 0;
    int dead_reckoned = 0;
    for (int t = 3; t < 120; ++t) {
      fed.drive_to(t);
      const bool certain = sigma(fed.output, 3) < limited.localized_below_m &&
                           sigma(fed.output, 0) < limited.localized_below_rad;
      EXPECT_EQ(fed.output.quality, certain ? Quality::kLocalized : Quality::kDeadReckoning) << t;
      ++(certain ? localized : dead_reckoned);
    }
    EXPECT_GT(localized, 5) << position;
    EXPECT_GT(dead_reckoned, 5) << position;
  }
}

// At rest its covariance does not grow; but nothing would tell it that it was wrong.
TEST_P(EitherFusion, IsNotLocalizedLongAfterTheLastAnswerHoweverCertain) {
  FedFusion fed(config());
  fed.drive.speed = 0.0;
  fed.drive_to(1.0);
  fed.answer_at(0.5);
  fed.drive_to(30.49);
  EXPECT_EQ(fed.output.quality, Quality::kLocalized);
  fed.drive_to(30.5);
  EXPECT_EQ(fed.output.quality, Quality::kDeadReckoning);
  fed.answer_at(29.0);
  fed.drive_to(31.0);
  EXPECT_EQ(fed.output.quality, Quality::kLocalized);
}

TEST_P(EitherFusion, IsLostWhenTheOdometryFallsSilent) {
  FedFusion fed(config());
  fed.drive_to(2.0);
  fed.answer_at(1.5);
  fed.drive_to(2.5, /*with_odometry=*/false);
  EXPECT_EQ(fed.output.quality, Quality::kLocalized);
  fed.drive_to(3.0, /*with_odometry=*/false);
  EXPECT_EQ(fed.output.quality, Quality::kLost);
  EXPECT_LT(distance(fed.output.T_odom_body, fed.drive.pose(3.0)), 1e-4);
}

// As along a corridor, or beside one thin pole: a pose to be known, but not to be driven by.
TEST_P(EitherFusion, IsLostWhileTheAnswerIsUncertainByMetresOrByManyDegrees) {
  for (const int axis : {2, 3}) {
    FedFusion fed(config());
    fed.drive_to(2.0);
    LocalizationResult uncertain = answer(1.0, true_T_map_odom() * fed.drive.pose(1.0));
    uncertain.covariance(axis, axis) = axis == 2 ? 0.3 * 0.3 : 3.0 * 3.0;
    EXPECT_TRUE(fed.fusion.add_answer(uncertain).has_value());
    fed.drive_to(2.1);
    EXPECT_EQ(fed.output.quality, Quality::kLost) << "axis " << axis;
    EXPECT_TRUE(fed.answer_at(2.0).has_value());
    fed.drive_to(2.2);
    EXPECT_EQ(fed.output.quality, Quality::kLocalized) << "axis " << axis;
  }
}

TEST(PoseFusion, RefusesAConfigurationWithMoreThanWhiteNoise) {
  auto reader = ConfigReader::from_string(default_config("robot"));
  reader.overlay(ConfigReader::from_string("fusion: {answers: {white_share: 1.1}}"));
  EXPECT_THROW(read_pose_fusion_config(reader.section("fusion")), ConfigError);
}

TEST_P(EitherFusion, EstimatesAtTheTimeOfAFrame) {
  FedFusion fed(config());
  fed.drive_to(2.0);
  fed.answer_at(1.0);
  for (const double t : {0.0, 0.7, 1.234, 1.9, 1.95, 2.0}) {
    const auto estimate = fed.fusion.estimate_at(at(t));
    ASSERT_TRUE(estimate) << t;
    EXPECT_EQ(estimate->stamp, at(t));
    EXPECT_LT(distance(estimate->T_odom_body, fed.drive.pose(t)), 1e-5);
    ASSERT_EQ(estimate->T_map_body.has_value(), !is_single() || t >= 1.0) << t;
    if (estimate->T_map_body) {
      EXPECT_LT(distance(*estimate->T_map_body, true_T_map_odom() * fed.drive.pose(t)),
                tolerance());
    }
  }
  EXPECT_FALSE(fed.fusion.estimate_at(at(2.001)));
  fed.drive_to(60.0);
  EXPECT_FALSE(fed.fusion.estimate_at(at(20.0)));
}

TEST(PoseFusion, RefusesAnUnknownFormulation) {
  auto reader = ConfigReader::from_string(default_config("robot"));
  reader.overlay(ConfigReader::from_string("fusion: {formulation: three_filters}"));
  EXPECT_THROW(read_pose_fusion_config(reader.section("fusion")), ConfigError);
}

TEST(PoseFusion, IsTheCoupledFilterInPaperMode) {
  auto reader = ConfigReader::from_string(default_config("everything"));
  reader.overlay(ConfigReader::from_file(FLEETLOC_SOURCE_DIR "/deploy/config/paper.yaml"));
  EXPECT_EQ(read_pose_fusion_config(reader.section("fusion")).formulation,
            PoseFusion::Formulation::kCoupled);
  EXPECT_TRUE(reader.section("submap").get<bool>("paper_mode"));
}

INSTANTIATE_TEST_SUITE_P(Fusion,
                         EitherFusion,
                         testing::Values(PoseFusion::Formulation::kDecoupled,
                                         PoseFusion::Formulation::kCoupled),
                         kFormulation);

}  // namespace
}  // namespace fleetloc
