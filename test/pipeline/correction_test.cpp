// Corrections from the localizer's solution through codec and network to the robot's end.
#include <algorithm>
#include <memory>

#include <gtest/gtest.h>

#include "deploy/replay/simulated_cloud.hpp"
#include "shared/compact/answer_sample.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/pipeline/simulated_system.hpp"
#include "test/unit/localizer/simulated_session.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

LocalizerPool pool_in_the_room() {
  return {"localizer", Incarnation{3}, room_map(), read_localizer_pool_config(defaults())};
}

// The newest keyframe with its predecessor, since an edge needs both in the full encoding.
Submap sent_submap(const SimulatedSession& robot, int keyframe) {
  Submap submap = robot.submap(keyframe);
  submap.robot = "robot";
  submap.incarnation = Incarnation{3};
  if (keyframe == 0) return submap;
  const Submap before = robot.submap(keyframe - 1);
  submap.keyframes.insert(submap.keyframes.begin(), before.keyframes[0]);
  submap.landmarks.insert(submap.landmarks.end(), before.landmarks.begin(), before.landmarks.end());
  std::ranges::sort(submap.landmarks, {}, &SubmapLandmark::id);
  const auto is_same = [](const SubmapLandmark& a, const SubmapLandmark& b) {
    return a.id == b.id;
  };
  submap.landmarks.erase(std::unique(submap.landmarks.begin(), submap.landmarks.end(), is_same),
                         submap.landmarks.end());
  return submap;
}

TEST(Corrections, GoOutWithEachLocalizedAnswer) {
  const SimulatedSession robot({.seed = 2, .send_landmarks = true});
  LocalizerPool pool = pool_in_the_room();
  RobotSession session = robot.session();
  session.localizer = "localizer";
  session.incarnation = Incarnation{3};
  pool.receive({Topic::kSession, encode(session)}, Timestamp{});
  int localized = 0;
  int corrected = 0;
  for (int i = 0; i < 14; ++i) {
    const Timestamp now{milliseconds(2000 * i)};
    pool.receive({Topic::kSubmap, encode(sent_submap(robot, i))}, now);
    auto job = pool.take_job(now);
    ASSERT_TRUE(job);
    LocalizationResult answer = LocalizerPool::run(*job);
    const bool is_localized = answer.status == LocalizationStatus::kLocalized;
    if (is_localized) ++localized;
    pool.finish(*job, std::move(answer), 1.0, now);
    for (int ms = 0; ms < 2000; ms += 100) {  // the answer is repeated meanwhile
      for (const auto& outgoing : pool.outgoing(now + milliseconds(ms), 0.0)) {
        if (outgoing.message.topic != Topic::kLocalization) continue;
        EXPECT_EQ(outgoing.partition, "robot");
        EXPECT_LE(outgoing.message.payload.size(), 480);
        const auto sent = decode_answer(outgoing.message.payload).value();
        if (!sent.correction || ms > 0) continue;  // repeated with its answer
        const Correction& correction = *sent.correction;
        ++corrected;
        EXPECT_TRUE(is_localized);
        EXPECT_EQ(correction.robot, "robot");
        EXPECT_EQ(correction.localizer, "localizer");
        EXPECT_EQ(correction.incarnation, Incarnation{3});
        EXPECT_EQ(correction.anchor, KeyframeId{static_cast<std::uint32_t>(i)});
      }
    }
  }
  EXPECT_GE(localized, 8);
  EXPECT_GE(corrected, localized - 2);  // the first window may hold too little to add anything
  EXPECT_LE(corrected, localized);
}

TEST(Corrections, ReachTheRobotOverTheNetworkAndAreTakenOnce) {
  const SimulatedSession robot({.seed = 3, .send_landmarks = true});
  MemoryNetwork network(perfect_link());
  const auto robot_end = network.join_robot("robot");
  const auto cloud_end = network.join_cloud("localizer");
  SimulatedCloud cloud(pool_in_the_room(), *cloud_end, milliseconds(50), {});
  CloudClient client("robot", *robot_end, read_cloud_client_config(defaults().section("client")));
  client.start_session(robot.session(), Timestamp{});
  int taken = 0;
  int landmarks = 0;
  int wrong = 0;  // on another surface than the landmark's own
  double nees_sum = 0.0;
  for (int ms = 0; ms < 6000; ms += 10) {
    const Timestamp now{milliseconds(ms)};
    if (ms >= 1000 && ms % 400 == 0) client.submit(sent_submap(robot, (ms - 1000) / 400), now);
    cloud.advance(now);
    for (const LocalizationResult& answer : client.take_answers(now)) {
      const auto correction = client.take_correction();
      if (!correction) continue;
      ++taken;
      EXPECT_EQ(answer.status, LocalizationStatus::kLocalized);
      EXPECT_EQ(correction->anchor, answer.keyframe);
      EXPECT_FALSE(correction->landmarks.empty());
      const Pose& T_map_anchor = robot.truth(correction->anchor);
      for (const auto& landmark : correction->landmarks) {
        const Eigen::Vector3d truth = inverse(T_map_anchor) * robot.run().landmark(landmark.id);
        const Eigen::Vector3d error = landmark.p_anchor - truth;
        const double nees = error.dot(landmark.information * error) / 3.0;
        wrong += static_cast<int>(nees > 9.0);
        nees_sum += nees;
        ++landmarks;
      }
      EXPECT_FALSE(client.take_correction());
    }
  }
  EXPECT_GE(taken, 5);
  EXPECT_GE(landmarks, 100);
  EXPECT_LT(nees_sum / landmarks, 1.5);
  EXPECT_LE(wrong, 0.03 * landmarks);
  std::printf("%d landmarks in %d corrections, %d wrong\n", landmarks, taken, wrong);
  EXPECT_TRUE(client.statistics().refused.empty());
}

}  // namespace
}  // namespace fleetloc
