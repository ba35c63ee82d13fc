#include "cloud/localizer/map_correction.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include "cloud/localizer/window_problem.hpp"
#include "mean.hpp"
#include "robot_window.hpp"
#include "simulated_session.hpp"

namespace fleetloc {
namespace {

constexpr int kRobotWindow = 10;  // keyframes
constexpr int kNewest = 41;

// A window of 40 keyframes, localized a few times on the way, as in a flight.
void localize_until(SessionLocalizer& localizer, const SimulatedSession& robot, int newest) {
  for (int i = 0; i <= newest; ++i) {
    localizer.add(robot.submap(i));
    if (i % 8 == 7 || i == newest) {
      ASSERT_EQ(name(localizer.localize().status), "localized") << "keyframe " << i;
    }
  }
}

struct Errors {
  Mean pose_nees, oldest_nees, landmark_nees, rotation, translation, landmark, chain;
};

void add_errors(const SimulatedSession& robot,
                const RelativeMarginals& marginals,
                const Correction& chosen,
                const Correction& used,
                Errors& errors) {
  RobotWindow window(robot, kNewest, kRobotWindow);
  window.solve(used);
  errors.pose_nees.add(window.pose_nees());
  errors.oldest_nees.add(window.oldest_nees());
  for (const auto& pair : marginals.relative_poses) {
    const Pose truth = inverse(robot.truth(pair.from)) * robot.truth(pair.to);
    const Vector6d error =
        local_coordinates(inverse(window.pose(pair.from)) * window.pose(pair.to), truth);
    errors.rotation.add(error.head<3>().squaredNorm());
    errors.translation.add(error.tail<3>().squaredNorm());
  }
  const KeyframeId first = marginals.relative_poses.front().from;
  errors.chain.add((window.pose(first).p - robot.truth(first).p).squaredNorm());
  for (const auto& landmark : chosen.landmarks) {
    if (!window.holds(landmark.id)) continue;
    errors.landmark.add(window.error(landmark.id).squaredNorm());
    errors.landmark_nees.add(window.nees(landmark.id));
  }
}

void print(const char* what, const Errors& e) {
  std::printf(
      "%-28s NEES/dof poses %.2f oldest %.2f landmarks %.2f; rms %.2f mrad %.2f mm, landmark %.1f "
      "mm, chain %.1f mm\n",
      what,
      e.pose_nees.value(),
      e.oldest_nees.value(),
      e.landmark_nees.value(),
      1e3 * e.rotation.root(),
      1e3 * e.translation.root(),
      1e3 * e.landmark.root(),
      1e3 * e.chain.root());
}

// The robot's own estimate, and with the correction that has these inflations.
struct Trial {
  const char* what;
  double pose_inflation;
  double landmark_inflation;
  Errors errors = {};
};

struct Items {
  Mean pose_nees, pose_gain, landmark_nees, landmark_gain, poses, landmarks;
};

void add_items(const SimulatedSession& robot, const RelativeMarginals& marginals, Items& items) {
  for (const auto& pair : marginals.relative_poses) {
    const Pose truth = inverse(robot.truth(pair.from)) * robot.truth(pair.to);
    items.pose_nees.add(
        nees_of(local_coordinates(pair.T_from_to, truth), pair.covariances.with_map));
    items.pose_gain.add(pair.covariances.gain());
  }
  for (const auto& landmark : marginals.landmarks) {
    const Eigen::Vector3d truth = inverse(robot.truth(kNewest)) * robot.run().landmark(landmark.id);
    items.landmark_nees.add(
        nees_of(Eigen::Vector3d(landmark.p_anchor - truth), landmark.covariances.with_map));
    items.landmark_gain.add(landmark.covariances.gain());
  }
}

TEST(MapCorrection, IsHonestItemByItemAndTogetherAndBetterThanTheRobotAlone) {
  constexpr int kSeeds = 12;
  const CorrectionConfig config = localizer_config().corrections;
  std::vector<Trial> trials{{"robot alone", 1e12, 1e12},
                            {"without inflation", 1.0, 1.0},
                            {"with it", config.pose_inflation, config.landmark_inflation}};
  Items items;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const SimulatedSession robot({.seed = seed, .noise_of_right_pixel = true});
    SessionLocalizer localizer(robot.session(), room_map(), localizer_config());
    localize_until(localizer, robot, kNewest);
    const auto marginals = relative_marginals(*localizer.system(), config.keyframes, config);
    ASSERT_TRUE(marginals);
    add_items(robot, *marginals, items);
    const Correction chosen = *localizer.correction();
    items.poses.add(static_cast<double>(chosen.relative_poses.size()));
    items.landmarks.add(static_cast<double>(chosen.landmarks.size()));
    for (Trial& trial : trials) {
      CorrectionConfig tried = config;
      tried.pose_inflation = trial.pose_inflation;
      tried.landmark_inflation = trial.landmark_inflation;
      add_errors(robot, *marginals, chosen, map_correction(*marginals, tried), trial.errors);
    }
  }
  std::printf("poses %.1f (gain %.2f, NEES %.2f), landmarks %.1f (gain %.2f, NEES %.2f)\n",
              items.poses.value(),
              items.pose_gain.value(),
              items.pose_nees.value(),
              items.landmarks.value(),
              items.landmark_gain.value(),
              items.landmark_nees.value());
  for (const Trial& trial : trials) print(trial.what, trial.errors);

  EXPECT_NEAR(items.pose_nees.value(), 1.0, 0.25);
  EXPECT_NEAR(items.landmark_nees.value(), 1.0, 0.3);
  const Errors& alone = trials.front().errors;
  const Errors& corrected = trials.back().errors;
  EXPECT_NEAR(alone.pose_nees.value(), 1.0, 0.25) << "the simulation, not the correction";
  EXPECT_NEAR(corrected.pose_nees.value(), 1.0, 0.25);
  EXPECT_LT(corrected.oldest_nees.value(), 1.3);
  EXPECT_LT(corrected.landmark_nees.value(), 1.3);
  EXPECT_LT(corrected.translation.root(), alone.translation.root());
  EXPECT_LT(corrected.rotation.root(), 1.02 * alone.rotation.root());
  EXPECT_LT(corrected.chain.root(), 0.85 * alone.chain.root());
  EXPECT_LT(corrected.landmark.root(), 0.6 * alone.landmark.root());
}

// A window at the truth, without matches.
struct Window {
  explicit Window(const SimulatedSession& robot)
      : database(localizer_config().database),
        problem(robot.run().stereo(), 40, localizer_config().registration.problem) {
    constexpr int kKeyframes = 20;
    std::map<KeyframeId, Pose> poses;
    for (int i = 0; i < kKeyframes; ++i) {
      database.add(robot.submap(i));
      poses[KeyframeId{static_cast<std::uint32_t>(i)}] = robot.truth(i);
    }
    problem.synchronize(database, poses);
    Vector6d sigmas;
    sigmas << Eigen::Vector3d::Constant(0.1), Eigen::Vector3d::Constant(1.0);
    problem.set_prior(
        KeyframeId{0}, robot.truth(0), sigmas.cwiseAbs2().cwiseInverse().asDiagonal());
  }

  SessionDatabase database;
  WindowProblem problem;
};

// On the plane through the landmark that it is seen upon.
MapMatch match_of(const WindowLandmark& landmark) {
  MapMatch match;
  match.landmark = landmark;
  match.q_map = landmark.p_map;
  match.normal = (landmark.viewpoint_map - landmark.p_map).normalized();
  match.is_planar = true;
  match.sigma_m = 0.03;
  return match;
}

TEST(MapCorrection, SendsNothingWithoutAMatchOrWithOneAlone) {
  const CorrectionConfig config = localizer_config().corrections;
  const SimulatedSession robot({.seed = 4, .noise_of_right_pixel = true});
  Window window(robot);
  ASSERT_TRUE(window.problem.solve(20, 0.003).is_usable);
  const auto sent = [&](const std::vector<MapMatch>& matches) {
    window.problem.set_matches(matches);
    EXPECT_TRUE(window.problem.solve(20, 0.003).is_usable);
    const auto marginals = relative_marginals(window.problem.system(), config.keyframes, config);
    EXPECT_TRUE(marginals);
    if (matches.empty()) {
      for (const auto& pair : marginals->relative_poses) {
        EXPECT_NEAR(pair.covariances.gain(), 0.0, 1e-4);
      }
    }
    const Correction correction = map_correction(*marginals, config);
    return correction.relative_poses.size() + correction.landmarks.size();
  };
  EXPECT_EQ(sent({}), 0U);

  std::vector<MapMatch> matches;
  for (const WindowLandmark& landmark : window.problem.landmarks()) {
    if (landmark.covariance.trace() < 0.01) matches.push_back(match_of(landmark));
  }
  ASSERT_GT(matches.size(), 50U);
  // It tells where the window is, and nothing of what is within.
  EXPECT_EQ(sent({matches.back()}), 0U);
  EXPECT_GT(sent(matches), 20U);
}

std::shared_ptr<const LaserMap> shifted(const LaserMap& map, const Eigen::Vector3f& by) {
  std::vector<MapPoint> points = map.points();
  for (MapPoint& point : points) point.p_map += by;
  return std::make_shared<const LaserMap>(std::move(points), map.info());
}

TEST(MapCorrection, StaysTheSameIfTheMapIsShiftedAsAWhole) {
  const auto map = shifted(*room_map(), {0.05F, -0.05F, 0.05F});
  const SimulatedSession robot({.seed = 5, .noise_of_right_pixel = true});
  SessionLocalizer right(robot.session(), room_map(), localizer_config());
  SessionLocalizer wrong(robot.session(), map, localizer_config());
  localize_until(right, robot, kNewest);
  localize_until(wrong, robot, kNewest);
  const auto place = [](const SessionLocalizer& localizer) -> Eigen::Vector3d {
    return localizer.database().keyframe(KeyframeId{kNewest}).T_map_body->p;
  };
  EXPECT_GT((place(wrong) - place(right)).norm(), 0.07);
  const Correction a = *right.correction();
  const Correction b = *wrong.correction();
  ASSERT_EQ(a.relative_poses.size(), b.relative_poses.size());
  for (std::size_t i = 0; i < a.relative_poses.size(); ++i) {
    const Vector6d change =
        local_coordinates(a.relative_poses[i].T_from_to, b.relative_poses[i].T_from_to);
    EXPECT_LT(change.head<3>().norm(), 5e-4);
    EXPECT_LT(change.tail<3>().norm(), 2e-3);
  }
  Mean squares;
  for (const auto& landmark : a.landmarks) {
    const auto same = std::ranges::find(b.landmarks, landmark.id, &Correction::Landmark::id);
    if (same != b.landmarks.end()) squares.add((same->p_anchor - landmark.p_anchor).squaredNorm());
  }
  EXPECT_GT(squares.count, 25);
  EXPECT_LT(squares.root(), 0.015);
  std::printf(
      "shifted map: %d landmarks change by %.1f mm rms\n", squares.count, 1e3 * squares.root());
}

TEST(MapCorrection, KeepsToItsLimitsAndComesOnlyWithASolution) {
  SessionLocalizer::Config config = localizer_config();
  config.corrections.max_landmarks = 12;
  config.corrections.keyframes = 4;
  const SimulatedSession robot({.seed = 6});
  SessionLocalizer localizer(robot.session(), room_map(), config);
  EXPECT_FALSE(localizer.correction());
  localize_until(localizer, robot, 20);
  const Correction correction = *localizer.correction();
  EXPECT_EQ(correction.anchor, KeyframeId{20});
  EXPECT_EQ(correction.landmarks.size(), 12U);
  EXPECT_LE(correction.relative_poses.size(), 3U);
  const double most = std::pow(config.corrections.landmark_floor_m, -2);
  for (const auto& landmark : correction.landmarks) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(landmark.information);
    EXPECT_GE(eigen.eigenvalues()(0), -1e-9 * most);
    EXPECT_LE(eigen.eigenvalues()(2), most);
  }
  EXPECT_TRUE(std::ranges::is_sorted(correction.landmarks, {}, &Correction::Landmark::id));

  Submap wrong = robot.submap(21);
  wrong.edges[0].T_from_to.p += Eigen::Vector3d(5.0, 0.0, 0.0);
  wrong.keyframes[0].observations.clear();
  localizer.add(wrong);
  EXPECT_NE(name(localizer.localize().status), "localized");
  EXPECT_FALSE(localizer.correction());
}

TEST(MapCorrection, LeavesOutWhatTheRobotWillNotHaveInItsWindowAnyMore) {
  const SimulatedSession robot({.seed = 6});
  SessionLocalizer localizer(robot.session(), room_map(), localizer_config());
  localize_until(localizer, robot, 20);
  const Duration interval =
      robot.submap(20).keyframes.back().stamp - robot.submap(19).keyframes.back().stamp;
  const auto oldest_after = [&](double intervals) {
    const auto correction = localizer.correction(from_seconds(intervals * to_seconds(interval)));
    return static_cast<int>(correction->relative_poses.front().from);
  };
  EXPECT_EQ(oldest_after(0.0), 13);  // of eight
  EXPECT_EQ(oldest_after(2.1), 13);
  EXPECT_EQ(oldest_after(5.1), 16);  // of five
  EXPECT_EQ(oldest_after(8.1), 19);
  const auto alone = localizer.correction(from_seconds(9.1 * to_seconds(interval)));
  EXPECT_TRUE(alone->relative_poses.empty());
  EXPECT_FALSE(alone->landmarks.empty());
  EXPECT_FALSE(localizer.correction(from_seconds(10.1 * to_seconds(interval))));
}

TEST(MapCorrections, AreOfTheKeyframesThatTheRobotStillHas) {
  using std::chrono::seconds;
  CorrectionConfig config = localizer_config().corrections;
  config.keyframes = 8;
  config.robot_window = 10;
  EXPECT_EQ(correctable_keyframes(seconds(1), seconds(0), config), 8);
  EXPECT_EQ(correctable_keyframes(seconds(1), seconds(4), config), 6);
  EXPECT_EQ(correctable_keyframes(seconds(1), seconds(10), config), 0);
}

// Stamps are what a robot says: they may all be the same.
TEST(MapCorrections, AreOfNoneIfTheirStampsDoNotIncrease) {
  using std::chrono::seconds;
  const CorrectionConfig config = localizer_config().corrections;
  for (const Duration round_trip : {seconds(0), seconds(1)}) {
    EXPECT_EQ(correctable_keyframes(seconds(0), round_trip, config), 0);
    EXPECT_EQ(correctable_keyframes(-seconds(1), round_trip, config), 0);
  }
}

}  // namespace
}  // namespace fleetloc
