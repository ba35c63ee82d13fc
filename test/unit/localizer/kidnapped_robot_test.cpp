// A robot that somebody carries to another place while its odometry goes on as if nothing had been.
#include <cmath>
#include <cstdio>
#include <optional>

#include <gtest/gtest.h>

#include "cloud/localizer/session_localizer.hpp"
#include "shared/geometry/so3.hpp"
#include "simulated_session.hpp"

namespace fleetloc {
namespace {

using enum LocalizationStatus;

/// From keyframe `kCarried` on it sees what a robot sees `kSkipped` keyframes later.
class KidnappedRobot {
 public:
  static constexpr int kCarried = 30;
  static constexpr int kSkipped = 41;

  explicit KidnappedRobot(std::uint64_t seed) : robot_({.seed = seed}) {}

  [[nodiscard]] RobotSession session() const { return robot_.session(); }
  [[nodiscard]] Pose truth(int keyframe) const { return robot_.truth(shown(keyframe)); }

  [[nodiscard]] Submap submap(int keyframe) const {
    if (keyframe < kCarried) return robot_.submap(keyframe);
    Submap submap = robot_.submap(shown(keyframe));
    submap.number = SampleNumber{static_cast<std::uint32_t>(keyframe)};
    SubmapKeyframe& item = submap.keyframes.front();
    item.id = KeyframeId{static_cast<std::uint32_t>(keyframe)};
    item.stamp = robot_.run().frame_stamp(keyframe);
    item.T_odom_body = T_before_after() * item.T_odom_body;
    for (StereoObservation& seen : item.observations) {
      seen.landmark = LandmarkId{static_cast<std::uint32_t>(seen.landmark) + 100'000};
    }
    VirtualEdge& edge = submap.edges.front();
    edge.from = KeyframeId{static_cast<std::uint32_t>(keyframe - 1)};
    edge.to = item.id;
    if (keyframe == kCarried) edge.T_from_to = robot_.submap(kCarried).edges.front().T_from_to;
    return submap;
  }

 private:
  static int shown(int keyframe) { return keyframe < kCarried ? keyframe : keyframe + kSkipped; }

  // Heading and place of the odometry go on.
  [[nodiscard]] Pose T_before_after() const {
    const Pose before = robot_.T_odom_body(kCarried);
    const Pose after = robot_.T_odom_body(kCarried + kSkipped);
    const Eigen::Quaterniond turn = before.R * after.R.conjugate();
    const Eigen::Quaterniond R = exp_so3({0.0, 0.0, 2.0 * std::atan2(turn.z(), turn.w())});
    return {R, before.p - R * after.p};
  }

  SimulatedSession robot_;
};

LocalizationResult answer_to_kidnapped(SessionLocalizer& localizer,
                                       const KidnappedRobot& robot,
                                       int i) {
  localizer.add(robot.submap(i));
  LocalizationResult answer = localizer.localize();
  while (localizer.is_searching() && answer.status != kLocalized) answer = localizer.localize();
  return answer;
}

// Found again where the room, which looks nearly the same turned by half, leaves no choice.
TEST(KidnappedRobot, IsSaidToBeLostAndIsFoundAgain) {
  constexpr int kSeeds = 2;
  constexpr int kKeyframes = 90;
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  int found = 0;
  int wrong = 0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const KidnappedRobot robot(seed);
    SessionLocalizer localizer(robot.session(), room_map(), localizer_config(), pyramid);
    std::optional<int> lost;
    std::optional<int> right;
    double way_m = 0.0;
    for (int i = 0; i < kKeyframes && !right; ++i) {
      const LocalizationResult answer = answer_to_kidnapped(localizer, robot, i);
      if (i > KidnappedRobot::kCarried && !lost) {
        way_m += (robot.truth(i).p - robot.truth(i - 1).p).norm();
      }
      if (answer.status == kLost && !lost) lost = i;
      if (answer.status != kLocalized) continue;
      const bool is_right = position_error(answer, robot.truth(i)) < 0.25;
      EXPECT_TRUE(is_right || i >= KidnappedRobot::kCarried) << i;
      if (lost && !is_right) ++wrong;
      if (lost && is_right) right = i;
    }
    std::printf("seed %d: lost after %d keyframes and %.1f m, found after %d\n",
                static_cast<int>(seed),
                lost ? *lost - KidnappedRobot::kCarried : -1,
                way_m,
                right ? *right - KidnappedRobot::kCarried : -1);
    ASSERT_TRUE(lost) << "seed " << seed;
    EXPECT_LT(way_m, 20.0) << "seed " << seed;
    if (right) ++found;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_GE(found, 1);
}

// Far beyond what the alignment around a start pose reaches.
TEST(KidnappedRobot, IsSearchedForThoughSomebodyToldAWrongStart) {
  const auto pyramid = make_pyramid(*room_map(), kSmallPyramid);
  SessionLocalizer::Config config = localizer_config();
  config.place_doubt.start_way_m = 6.0;
  for (std::uint64_t seed = 1; seed <= 1; ++seed) {
    const SimulatedSession robot({.seed = seed, .start_offset_m = 4.0, .start_yaw_rad = 1.5});
    SessionLocalizer localizer(robot.session(), room_map(), config, pyramid);
    bool was_lost = false;
    std::optional<int> localized;
    for (int i = 0; i < 80 && !localized; ++i) {
      localizer.add(robot.submap(i));
      LocalizationResult answer = localizer.localize();
      was_lost = was_lost || answer.status == kLost;
      while (localizer.is_searching()) answer = localizer.localize();
      if (answer.status != kLocalized) continue;
      localized = i;
      EXPECT_LT(position_error(answer, robot.truth(i)), 0.25) << "seed " << seed;
    }
    EXPECT_TRUE(was_lost) << "seed " << seed;
    EXPECT_TRUE(localized) << "seed " << seed;
  }
}

}  // namespace
}  // namespace fleetloc
