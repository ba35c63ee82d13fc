#include "robot/pipeline/session_start.hpp"

#include <random>

#include <gtest/gtest.h>

#include "robot/pipeline/robot_pipeline.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// What a person says of a pose in the map, as seen at the origin of odom some metres away.
TEST(MapOdomEstimate, HasTheCovarianceOfPosesDrawnAroundIt) {
  constexpr StartUncertainty kSigma{.position_sigma_m = 0.05,
                                    .yaw_sigma_rad = 0.02,
                                    .tilt_sigma_rad = 0.004,
                                    .max_carried_sigma_m = 1.0};
  constexpr int kDraws = 40'000;
  const Pose T_map_body{exp_so3({0.7, -1.2, 2.0}), {12.0, -3.0, 1.0}};
  const Pose T_odom_body{exp_so3({-0.4, 0.9, 0.3}), {4.0, 2.0, -1.5}};
  const MapOdomEstimate start = map_odom_estimate_at(T_map_body, T_odom_body, covariance(kSigma));

  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  Matrix6d sum = Matrix6d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const auto draw = [&](double sigma) { return sigma * normal(random); };
    const double roll = draw(kSigma.tilt_sigma_rad);
    const double pitch = draw(kSigma.tilt_sigma_rad);
    const double yaw = draw(kSigma.yaw_sigma_rad);
    const Eigen::Vector3d shift =
        Eigen::Vector3d::NullaryExpr([&] { return draw(kSigma.position_sigma_m); });
    const Pose truth{exp_so3({roll, pitch, yaw}) * T_map_body.R, T_map_body.p + shift};
    const Vector6d error = local_coordinates(start.T_map_odom, truth * inverse(T_odom_body));
    sum += error * error.transpose();
  }
  EXPECT_LT((sum / kDraws - start.covariance).norm(), 0.03 * start.covariance.norm());
  const Pose back = start.T_map_odom * T_odom_body;
  EXPECT_LT(local_coordinates(back, T_map_body).norm(), 1e-12);
}

constexpr StartUncertainty kUser{.position_sigma_m = 0.1,
                                 .yaw_sigma_rad = 0.05,
                                 .tilt_sigma_rad = 0.01,
                                 .max_carried_sigma_m = 0.75};
constexpr ImuGapModel kGaps = [] {
  ImuGapModel gaps;
  gaps.speed_sigma = 1.0;
  gaps.turn_rate_sigma = 0.2;
  return gaps;
}();
const Pose kT_map_body{exp_so3({0.0, 0.0, 2.0}), {12.0, -3.0, 1.0}};

Timestamp at_second(int second) {
  return Timestamp{std::chrono::seconds(second)};
}

/// An odometry that began 2 s and 1 m after the first frame.
OdometryStart observed_start() {
  return {.stamp = at_second(2),
          .T_odom_body = {Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}},
          .T_first_newest = Pose{Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}},
          .continued = std::nullopt};
}

/// The same after a reset, from a dead-reckoned pose with this sigma.
OdometryStart continued_start_with(double sigma_m) {
  OdometryStart start = observed_start();
  start.T_first_newest.reset();
  start.continued = PoseEstimate{};
  start.continued->covariance_odom = sigma_m * sigma_m * Matrix6d::Identity();
  return start;
}

double sigma_m(const MapOdomEstimate& start, const Pose& T_odom_body) {
  const Matrix6d A = adjoint(inverse(T_odom_body));
  return std::sqrt((A * start.covariance * A.transpose())(3, 3));
}

TEST(SessionStart, IsUnknownIfNobodyHasToldIt) {
  SessionStart session_start(std::nullopt, kUser, kGaps);
  const OdometryStart begin = observed_start();
  EXPECT_EQ(session_start.of_session(begin, begin.T_odom_body, {}).error(), NoStart::kUnknown);
}

TEST(SessionStart, IsTheUsersMovedByWhatTheOdometryHasSeenSince) {
  SessionStart session_start(kT_map_body, kUser, kGaps);
  const OdometryStart begin = observed_start();
  const auto start = session_start.of_session(begin, begin.T_odom_body, {});
  ASSERT_TRUE(start.has_value());
  const Pose expected = kT_map_body * *begin.T_first_newest;
  EXPECT_LT(local_coordinates(start->T_map_odom * begin.T_odom_body, expected).norm(), 1e-9);
  EXPECT_NEAR(sigma_m(*start, begin.T_odom_body), 0.1, 1e-9);
}

TEST(SessionStart, IsAsUncertainAsWhatTheRobotMayHaveDoneUnobserved) {
  StartUncertainty patient = kUser;
  patient.max_carried_sigma_m = 10.0;
  OdometryStart begin = observed_start();
  begin.T_first_newest.reset();
  for (const bool is_patient : {true, false}) {
    SessionStart session_start(kT_map_body, is_patient ? patient : kUser, kGaps);
    session_start.note_frame(at_second(0));
    session_start.note_frame(at_second(1));
    const auto start = session_start.of_session(begin, begin.T_odom_body, {});
    ASSERT_EQ(start.has_value(), is_patient);
    if (is_patient) {
      EXPECT_NEAR(sigma_m(*start, begin.T_odom_body), std::hypot(0.1, 2.0), 1e-9);
    } else {
      EXPECT_EQ(start.error(), NoStart::kTooUncertain);
    }
  }
}

TEST(SessionStart, TakesTheAnswersBeforeTheUser) {
  SessionStart session_start(kT_map_body, kUser, kGaps);
  const MapOdomEstimate from_answers{.T_map_odom = {}, .covariance = 1e-4 * Matrix6d::Identity()};
  const OdometryStart begin = continued_start_with(0.1);
  const auto start = session_start.of_session(begin, begin.T_odom_body, from_answers);
  ASSERT_TRUE(start.has_value());
  EXPECT_EQ(start->covariance, from_answers.covariance);
}

TEST(SessionStart, GrowsOverResetsUntilItIsWithheld) {
  SessionStart session_start(kT_map_body, kUser, kGaps);
  const OdometryStart first = observed_start();
  ASSERT_TRUE(session_start.of_session(first, first.T_odom_body, {}).has_value());
  const OdometryStart next = continued_start_with(0.5);
  const auto start = session_start.of_session(next, next.T_odom_body, {});
  ASSERT_TRUE(start.has_value());
  EXPECT_GT(sigma_m(*start, next.T_odom_body), 0.5);
  EXPECT_EQ(session_start.of_session(next, next.T_odom_body, {}).error(), NoStart::kTooUncertain);
}

TEST(SessionStart, IsNotThatOfAnOdomThatIsGone) {
  SessionStart session_start(std::nullopt, kUser, kGaps);
  OdometryStart begin = continued_start_with(0.1);
  const MapOdomEstimate from_answers{.T_map_odom = {}, .covariance = 1e-4 * Matrix6d::Identity()};
  ASSERT_TRUE(session_start.of_session(begin, begin.T_odom_body, from_answers).has_value());
  begin.continued.reset();
  EXPECT_EQ(session_start.of_session(begin, begin.T_odom_body, {}).error(), NoStart::kUnknown);
}

double sigma_along_map(const MapOdomEstimate& start, const Pose& T_odom_body, int axis) {
  const Matrix6d A = adjoint(inverse(T_odom_body));
  const Matrix6d covariance = A * start.covariance * A.transpose();
  const Eigen::Matrix3d R = (start.T_map_odom * T_odom_body).R.toRotationMatrix();
  const auto block = axis < 3 ? covariance.topLeftCorner<3, 3>().eval()
                              : covariance.bottomRightCorner<3, 3>().eval();
  return std::sqrt((R * block * R.transpose())(axis % 3, axis % 3));
}

/// As RViz tells it: flat on the ground, with what it knows of x, y and yaw.
GivenPose from_rviz() {
  GivenPose given{.T_map_body = {exp_so3({0.0, 0.0, 2.0}), {12.0, -3.0, 0.0}}};
  const Eigen::Matrix3d R = given.T_map_body.R.toRotationMatrix();
  const Eigen::Vector3d flat(0.25, 0.25, 0.0);
  given.covariance(2, 2) = 0.0685;
  given.covariance.bottomRightCorner<3, 3>() = R.transpose() * flat.asDiagonal() * R;
  return given;
}

TEST(SessionStart, OfAPlacedRobotHasItsOwnTiltAndTheUncertaintyThatWasTold) {
  const Pose T_odom_body{exp_so3({0.0, 0.0, -1.0}) * exp_so3({0.1, -0.2, 0.0}), {4.0, 2.0, -1.0}};
  SessionStart session_start(std::nullopt, kUser, kGaps);
  const MapOdomEstimate start = session_start.place(from_rviz(), T_odom_body);
  const Eigen::Vector3d up_in_odom = start.T_map_odom.R.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT((up_in_odom - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  const Pose T_map_body = start.T_map_odom * T_odom_body;
  EXPECT_LT((T_map_body.p - from_rviz().T_map_body.p).norm(), 1e-9);
  const double turn = log_so3(from_rviz().T_map_body.R.conjugate() * T_map_body.R).norm();
  EXPECT_NEAR(turn, std::hypot(0.1, 0.2), 0.01) << "the tilt, and no yaw";
  for (const int axis : {0, 1}) EXPECT_NEAR(sigma_along_map(start, T_odom_body, axis), 0.01, 1e-9);
  EXPECT_NEAR(sigma_along_map(start, T_odom_body, 2), std::sqrt(0.0685), 1e-6);
  for (const int axis : {3, 4}) EXPECT_NEAR(sigma_along_map(start, T_odom_body, axis), 0.5, 1e-6);
  EXPECT_NEAR(sigma_along_map(start, T_odom_body, 5), 0.1, 1e-9) << "of which nothing was told";
}

TEST(SessionStart, OfAPlacedRobotReplacesWhatWasKnown) {
  SessionStart session_start(kT_map_body, kUser, kGaps);
  const OdometryStart first = observed_start();
  ASSERT_TRUE(session_start.of_session(first, first.T_odom_body, {}).has_value());
  const MapOdomEstimate placed = session_start.place(from_rviz(), first.T_odom_body);
  const OdometryStart next = continued_start_with(0.01);
  const auto start = session_start.of_session(next, next.T_odom_body, {});
  ASSERT_TRUE(start.has_value());
  EXPECT_LT(local_coordinates(start->T_map_odom, placed.T_map_odom).norm(), 1e-9);
  OdometryStart anew = next;
  anew.continued.reset();
  EXPECT_EQ(session_start.of_session(anew, anew.T_odom_body, {}).error(), NoStart::kUnknown)
      << "not the pose at the first frame, which was another";
}

TEST(SessionStart, OfARobotPlacedBeforeItsOdometryKnowsNotWhenOnItsWay) {
  SessionStart session_start(std::nullopt, kUser, kGaps);
  GivenPose given = from_rviz();
  session_start.place_before_odometry(given);
  const OdometryStart begin = observed_start();  // 1 m later
  const auto start = session_start.of_session(begin, begin.T_odom_body, {});
  ASSERT_TRUE(start.has_value());
  const Pose expected = given.T_map_body * *begin.T_first_newest;
  EXPECT_LT(local_coordinates(start->T_map_odom * begin.T_odom_body, expected).norm(), 1e-9);
  EXPECT_NEAR(sigma_along_map(*start, begin.T_odom_body, 3), std::hypot(0.5, 1.0), 1e-6);
}

TEST(StartRegion, IsANameOrACircle) {
  EXPECT_EQ(start_region("hall_B").name, "hall_B");
  const StartRegion circle = start_region("10 -20.5 30");
  EXPECT_EQ(circle.name, "");
  EXPECT_EQ(circle.center_map, Eigen::Vector2d(10.0, -20.5));
  EXPECT_EQ(circle.radius_m, 30.0);
  for (const char* text : {"", "hall B", "1 2", "1 2 0", "1 2 -3", "1 2 3 4"}) {
    EXPECT_THROW(start_region(text), std::invalid_argument) << text;
  }
}

}  // namespace
}  // namespace fleetloc
