#include "robot/node/ros2_diagnostics.hpp"

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Pair;
using Level = DiagnosticStatus::Level;

enum Part : std::size_t { kLocalization, kSensors, kLink };

DiagnosticStatus part(Part part,
                      const std::optional<PoseEstimate>& pose,
                      const SensorState& sensors = {}) {
  RobotState state;
  state.pose = pose;
  state.traffic.uplink_bytes = 17;
  return robot_diagnostics("robot_1", state, sensors).at(part);
}

PoseEstimate pose_of(Quality quality) {
  PoseEstimate pose;
  pose.quality = quality;
  return pose;
}

TEST(RobotDiagnostics, SayHowFarTheLocalizationMayBeTrusted) {
  EXPECT_EQ(part(kLocalization, std::nullopt).message, "initializing");
  EXPECT_EQ(part(kLocalization, pose_of(Quality::kLocalized)).level, Level::kOk);
  EXPECT_EQ(part(kLocalization, pose_of(Quality::kDeadReckoning)).level, Level::kWarning);
  EXPECT_EQ(part(kLocalization, pose_of(Quality::kLost)).level, Level::kError);
  EXPECT_EQ(part(kLocalization, pose_of(Quality::kLost)).message, "lost");
}

TEST(RobotDiagnostics, HaveOneSigmaOfThePosition) {
  PoseEstimate pose = pose_of(Quality::kLocalized);
  pose.T_map_body = Pose{};
  pose.covariance_map.diagonal() << 1.0, 1.0, 1.0, 4.0, 4.0, 1.0;
  EXPECT_THAT(part(kLocalization, pose).values, Contains(Pair("map_sigma_m", "3")));
}

TEST(RobotDiagnostics, TellWhoHasAnsweredAndHowFarTheAnswerWasFromThePose) {
  RobotState state;
  state.pose = pose_of(Quality::kLocalized);
  state.answer.emplace();
  state.answer->answer.localizer = "localizer_1";
  state.answer->outcome = unexpected(FusionRejection::kGated);
  state.answer->innovation = (Vector6d() << 0.1, 0.0, 0.0, 0.3, 0.4, 0.0).finished();
  const auto values = robot_diagnostics("robot_1", state, {}).at(kLocalization).values;
  EXPECT_THAT(values, Contains(Pair("localizer", "localizer_1")));
  EXPECT_THAT(values, Contains(Pair("last_answer", "gated")));
  EXPECT_THAT(values, Contains(Pair("innovation_m", "0.5")));
  EXPECT_THAT(values, Contains(Pair("innovation_deg", HasSubstr("5.7"))));
}

TEST(RobotDiagnostics, TellAtHowManyPlacesTheRobotMayBe) {
  RobotState state;
  state.pose = pose_of(Quality::kSearching);
  state.answer.emplace();
  state.answer->answer.places = 3;
  const auto values = robot_diagnostics("robot_1", state, {}).at(kLocalization).values;
  EXPECT_THAT(values, Contains(Pair("possible_places", "3")));
}

TEST(RobotDiagnostics, NameTopicsThatAreSilentAndCountFaults) {
  EXPECT_EQ(part(kSensors, std::nullopt).level, Level::kOk);
  const SensorState sensors{.silent_topics = {"/imu"},
                            .faults = {{"imu_doubled", 3}, {"clock_steps", 0}}};
  const DiagnosticStatus status = part(kSensors, std::nullopt, sensors);
  EXPECT_EQ(status.level, Level::kError);
  EXPECT_THAT(status.message, HasSubstr("/imu"));
  EXPECT_THAT(status.values, testing::ElementsAre(Pair("imu_doubled", "3")));
}

TEST(RobotDiagnostics, TellOfTheLinkAndTheRobot) {
  const DiagnosticStatus status = part(kLink, std::nullopt);
  EXPECT_EQ(status.level, Level::kWarning);
  EXPECT_EQ(status.hardware, "robot_1");
  EXPECT_THAT(status.values, Contains(Pair("uplink_bytes", "17")));
}

}  // namespace
}  // namespace fleetloc
