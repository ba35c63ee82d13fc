#include "deploy/replay/icp_localizer.hpp"

#include <gmock/gmock.h>

#include "deploy/config/default_config.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using testing::IsEmpty;
using testing::SizeIs;

constexpr Timestamp kStart{std::chrono::seconds(1000)};
constexpr Duration kTime = milliseconds(50);

/// The corner of a room, a point every 0.1 m.
std::vector<MapPoint> corner() {
  std::vector<MapPoint> points;
  for (int i = 0; i < 50; ++i) {
    for (int k = 0; k < 50; ++k) {
      const float a = 0.1F * static_cast<float>(i);
      const float b = 0.1F * static_cast<float>(k);
      points.push_back({.p_map = {a, b, 0.0F}});
      points.push_back({.p_map = {a, 0.0F, b}});
      points.push_back({.p_map = {0.0F, a, b}});
    }
  }
  return points;
}

class IcpLocalizerTest : public testing::Test {
 protected:
  static IcpLocalizer::Config config() {
    auto reader = ConfigReader::from_string(default_config("everything"), "defaults");
    return read_icp_localizer_config(reader.section("icp_baseline"));
  }

  static RobotSession session(const Pose& T_map_odom) {
    RobotSession session;
    session.robot = "robot";
    session.session = SessionNumber{4};
    session.start = MapOdomEstimate{.T_map_odom = T_map_odom};
    return session;
  }

  /// Of a robot at rest that sees the corner.
  [[nodiscard]] Submap submap(std::uint32_t keyframe) const {
    Submap submap;
    SubmapKeyframe newest;
    newest.id = KeyframeId{keyframe};
    newest.stamp = kStart;
    submap.keyframes.push_back(newest);
    std::uint32_t id = 0;
    for (std::size_t i = 0; i < map_->size(); i += 31) {
      const Eigen::Vector3d p_map = map_->point(i).p_map.cast<double>();
      submap.landmarks.push_back({.id = LandmarkId{id++}, .p_odom = inverse(T_map_odom_) * p_map});
    }
    return submap;
  }

  static std::shared_ptr<const LaserMap> corner_map() {
    MapInfo info;
    info.resolution_m = 0.1;
    info.hash = {7};
    return std::make_shared<const LaserMap>(corner(), info);
  }

  std::shared_ptr<const LaserMap> map_ = corner_map();
  Pose T_map_odom_{.R = exp_so3(Eigen::Vector3d(0.0, 0.0, 0.5)), .p = Eigen::Vector3d(2, 2, 1)};
  IcpLocalizer localizer_{map_, config(), kTime};
};

TEST_F(IcpLocalizerTest, AlignsASubmapFromTheStartPose) {
  Pose start = T_map_odom_;
  start.p.x() += 0.04;
  localizer_.start_session(session(start), kStart);
  localizer_.submit(submap(3), kStart);
  EXPECT_THAT(localizer_.take_answers(kStart), IsEmpty());
  const auto answers = localizer_.take_answers(kStart + kTime);
  ASSERT_THAT(answers, SizeIs(1));
  EXPECT_EQ(answers.front().status, LocalizationStatus::kLocalized);
  EXPECT_EQ(answers.front().keyframe, KeyframeId{3});
  EXPECT_EQ(answers.front().robot, "robot");
  EXPECT_EQ(answers.front().session, SessionNumber{4});
  EXPECT_EQ(answers.front().map_hash, map_->info().hash);
  EXPECT_LT(local_coordinates(T_map_odom_, answers.front().T_map_body).norm(), 0.005);
}

TEST_F(IcpLocalizerTest, BeginsWhereTheLastAnswerHasEnded) {
  Pose start = T_map_odom_;
  start.p.x() += 0.04;
  localizer_.start_session(session(start), kStart);
  localizer_.submit(submap(3), kStart);
  static_cast<void>(localizer_.take_answers(kStart + kTime));
  // Landmarks that say nothing: the start is what comes out.
  Submap empty = submap(4);
  empty.landmarks.resize(2);
  localizer_.submit(empty, kStart + 2 * kTime);
  localizer_.submit(submap(5), kStart + 3 * kTime);
  const auto answers = localizer_.take_answers(kStart + 4 * kTime);
  ASSERT_THAT(answers, SizeIs(2));
  EXPECT_EQ(answers[0].status, LocalizationStatus::kNotConverged);
  EXPECT_EQ(answers[1].status, LocalizationStatus::kLocalized);
  EXPECT_LT(local_coordinates(T_map_odom_, answers[1].T_map_body).norm(), 0.005);
}

TEST_F(IcpLocalizerTest, TakesTheNewestOfWhatHasWaited) {
  localizer_.start_session(session(T_map_odom_), kStart);
  for (const std::uint32_t keyframe : {3U, 4U, 5U}) localizer_.submit(submap(keyframe), kStart);
  ASSERT_THAT(localizer_.take_answers(kStart + kTime), SizeIs(1));
  const auto later = localizer_.take_answers(kStart + 2 * kTime);
  ASSERT_THAT(later, SizeIs(1));
  EXPECT_EQ(later.front().keyframe, KeyframeId{5});
}

TEST_F(IcpLocalizerTest, NamesWhyItRefuses) {
  const auto status = [&](std::optional<Pose> start, const Submap& submap) {
    RobotSession its = session(start.value_or(Pose{}));
    if (!start) its.start.reset();
    localizer_.start_session(its, kStart);
    localizer_.submit(submap, kStart);
    return localizer_.take_answers(kStart + kTime).front().status;
  };
  EXPECT_EQ(status(std::nullopt, submap(3)), LocalizationStatus::kSearching);
  Pose above = T_map_odom_;
  above.p.z() += 30.0;
  EXPECT_EQ(status(above, submap(3)), LocalizationStatus::kNotConverged);
  Submap cluttered = submap(3);
  for (SubmapLandmark& landmark : cluttered.landmarks) {
    if (static_cast<std::uint32_t>(landmark.id) % 4 != 0) landmark.p_odom.z() += 20.0;
  }
  EXPECT_EQ(status(T_map_odom_, cluttered), LocalizationStatus::kTooFewMatches);
  Submap rough = submap(3);
  for (SubmapLandmark& landmark : rough.landmarks) {
    const double sign = static_cast<std::uint32_t>(landmark.id) % 2 == 0 ? 1.0 : -1.0;
    landmark.p_odom += Eigen::Vector3d::Constant(0.5 * sign);
  }
  EXPECT_EQ(status(T_map_odom_, rough), LocalizationStatus::kPoorFit);
}

TEST_F(IcpLocalizerTest, ForgetsWhatCameBeforeTheSession) {
  localizer_.submit(submap(3), kStart);
  localizer_.start_session(session(T_map_odom_), kStart);
  localizer_.submit(submap(4), kStart);
  localizer_.start_session(session(T_map_odom_), kStart);
  EXPECT_THAT(localizer_.take_answers(kStart + 2 * kTime), IsEmpty());
}

}  // namespace
}  // namespace fleetloc
