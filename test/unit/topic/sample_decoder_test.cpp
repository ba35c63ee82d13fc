#include "deploy/topic/sample_decoder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/topic/sample_text.hpp"
#include "shared/compact/answer_sample.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/wire/pose_codec.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/unit/compact/moving_robot.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;
using Json = SampleDecoder::Json;

RobotSession session_of(const Submap& submap) {
  RobotSession session;
  session.robot = submap.robot;
  session.session = submap.session;
  session.localizer = "alpha";
  session.encoding = SubmapEncoding::kCompact;
  session.stereo = some_stereo();
  return session;
}

TEST(SampleDecoder, ShowsACompactSubmapOnceItsSessionIsKnown) {
  Submap submap = moving_robot(100, 3);
  const Bytes bytes =
      encode_compact(submap, {.newest = 12, .loss = 0.2, .age = {}}, {}, some_stereo());
  SampleDecoder decoder;
  const Json early = decoder.decode("fleetloc/2/alpha/submap", bytes);
  EXPECT_EQ(early["number"], 40);
  EXPECT_THAT(early["error"].get<std::string>(), HasSubstr("session"));
  EXPECT_FALSE(early.contains("keyframes"));

  const Json session = decoder.decode("fleetloc/2/alpha/session", encode(session_of(submap)));
  EXPECT_EQ(session["encoding"], "compact");
  EXPECT_EQ(session["stereo"]["focal_px"], 458.0);
  const Json shown = decoder.decode("fleetloc/2/alpha/submap", bytes);
  EXPECT_FALSE(shown.contains("error"));
  EXPECT_EQ(shown["answer"], 12);
  ASSERT_EQ(shown["keyframes"].size(), 3);
  const SubmapKeyframe& sent = submap.keyframes[1];
  EXPECT_EQ(shown["keyframes"][1]["id"], 101);
  const Json& observations = shown["keyframes"][1]["observations"];
  ASSERT_EQ(observations.size(), sent.observations.size());
  EXPECT_EQ(observations[0][0], static_cast<std::uint32_t>(sent.observations[0].landmark));
  EXPECT_NEAR(observations[0][1].get<double>(), sent.observations[0].left.x(), 0.26);
  EXPECT_FALSE(shown["landmarks"].empty());
  ASSERT_EQ(shown["edges"].size(), 2);
  EXPECT_EQ(shown["edges"][1]["to"], 102);
  EXPECT_NEAR(shown["edges"][1]["sigma"][3].get<double>(), 0.005, 0.001);
}

TEST(SampleDecoder, DoesNotTakeTheCalibrationOfAnotherSession) {
  const Submap submap = moving_robot(100, 3);
  RobotSession other = session_of(submap);
  other.session = SessionNumber{4};
  SampleDecoder decoder;
  decoder.decode("fleetloc/2/alpha/session", encode(other));
  EXPECT_TRUE(
      decoder.decode("fleetloc/2/alpha/submap", encode_compact(submap, {}, {}, some_stereo()))
          .contains("error"));
}

TEST(SampleDecoder, ShowsAnswersWithTheirCorrections) {
  SampleDecoder decoder;
  const LocalizationResult result = some_answer();
  const Json shown = decoder.decode("fleetloc/2/robot_1/localization",
                                    encode(Answer{result, some_correction()}, 1200));
  EXPECT_EQ(shown["status"], "localized");
  EXPECT_NEAR(shown["T_map_body"]["translation"][0].get<double>(), result.T_map_body.p.x(), 1e-9);
  EXPECT_FALSE(shown["correction"]["landmarks"].empty());
  EXPECT_FALSE(shown["acknowledged"].empty());
}

TEST(SampleDecoder, ShowsStatusesAndPoses) {
  SampleDecoder decoder;
  EXPECT_EQ(
      decoder.decode("fleetloc/2/localizers",
                     encode(LocalizerStatus{.localizer = "alpha", .sessions = 3}))["sessions"],
      3);
  RobotStatus status;
  status.robot = "robot_1";
  status.quality = Quality::kLost;
  EXPECT_EQ(decoder.decode("fleetloc/2/alpha/robot_status", encode(status))["quality"], "lost");
  RobotPoseEstimate pose{.robot = "robot_1", .estimate = {}};
  pose.estimate.T_map_body = Pose{Eigen::Quaterniond::Identity(), {1.0, 2.0, 3.0}};
  EXPECT_EQ(decoder.decode("fleetloc/pose", encode(pose))["T_map_body"]["translation"][2], 3.0);
}

TEST(SampleDecoder, SaysWhatIsWrongWithASample) {
  SampleDecoder decoder;
  for (const char* topic : {"fleetloc/2/localizers",
                            "fleetloc/2/a/session",
                            "fleetloc/2/a/submap",
                            "fleetloc/2/a/full_submap",
                            "fleetloc/2/a/robot_status",
                            "fleetloc/2/a/localization",
                            "fleetloc/pose"}) {
    EXPECT_EQ(decoder.decode(topic, Bytes{0, 1, 0, 0, 255}), (Json{{"error", "undecodable"}}))
        << topic;
  }
}

TEST(SampleText, IsYaml) {
  const Json sample = Json::parse(
      R"({"robot": "robot_1", "load": 0.5, "hash": "0e12", "empty": [],
          "pose": {"translation": [1.0, 2.0]},
          "edges": [{"from": 1, "sigma": [0.1, 0.2]}, {"from": 2, "sigma": []}],
          "observations": [[7, 1.5], [8, 2.5]]})");
  EXPECT_EQ(sample_text(sample),
            "robot: robot_1\n"
            "load: 0.5\n"
            "hash: \"0e12\"\n"
            "empty: []\n"
            "pose:\n"
            "  translation: [1.0, 2.0]\n"
            "edges:\n"
            "  - from: 1\n"
            "    sigma: [0.1, 0.2]\n"
            "  - from: 2\n"
            "    sigma: []\n"
            "observations:\n"
            "  - [7, 1.5]\n"
            "  - [8, 2.5]\n");
}

}  // namespace
}  // namespace fleetloc
