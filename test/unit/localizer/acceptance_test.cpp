// Each threshold of the acceptance, with the values that ship, against a situation that it is there
// for: what a robot in a yard sees of it, and one thing that is wrong.
#include "cloud/localizer/acceptance.hpp"

#include <cmath>
#include <set>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "shared/geometry/covariance.hpp"
#include "shared/geometry/so3.hpp"
#include "simulated_session.hpp"
#include "simulated_yard.hpp"

namespace fleetloc {
namespace {

constexpr unsigned kOnGround = 100;  // landmarks of the yard; those that follow are on walls

std::string_view said(const Acceptance::Verdict& verdict) {
  return verdict ? "accepted" : name(verdict.error());
}

unsigned number_of(const WindowLandmark& landmark) {
  return static_cast<unsigned>(landmark.id);
}

// From its wall towards the middle of the yard, or, by a negative distance, behind the wall.
void put_before(WindowLandmark& landmark, double metres) {
  const bool is_at_x = std::abs(landmark.p_map.x()) > 9.5;
  double& across = is_at_x ? landmark.p_map.x() : landmark.p_map.y();
  across -= metres * std::copysign(1.0, across);
}

// Nothing vouches for a place.
const PoseWithCovariance kUnknown{Pose{}, Matrix6d::Identity()};

class AcceptanceTest : public testing::Test {
 protected:
  static Acceptance session() {
    return {config().acceptance, config().confirmation, config().place_doubt};
  }

  static MapFit fit_of(const std::vector<WindowLandmark>& landmarks) {
    static const LaserMap map = yard();
    const AssociationConfig& association = config().registration.association;
    LandmarkPositions positions;
    for (const WindowLandmark& landmark : landmarks) positions[landmark.id] = landmark.p_map;
    MapFit fit;
    fit.association =
        associate(landmarks, map, config().registration.rounds.final_gate_m, association);
    fit.is_solved = true;
    fit.median_residual = median_residual(fit.association.matches, positions, association);
    return fit;
  }

  // Of a window that is dead-reckoned to the yard's middle, to 1 cm and 2 mrad.
  static MapFit fit_at(const Pose& T_map_body) {
    MapFit fit = fit_of(landmarks_of_yard(1.0));
    fit.innovation_sigmas =
        session().innovation_sigmas({Pose{}, diagonal_covariance(0.002, 0.01)}, T_map_body);
    return fit;
  }

  static std::string_view said_of(const std::vector<WindowLandmark>& landmarks) {
    return said(session().check_fit(fit_of(landmarks), false));
  }
  // At the first localization of a session.
  static std::string_view said_at_first(const std::vector<WindowLandmark>& landmarks) {
    Acceptance acceptance = session();
    const MapFit fit = fit_of(landmarks);
    const Acceptance::Verdict fits = acceptance.check_fit(fit, true);
    return said(fits ? acceptance.confirm(fit, kUnknown, Pose{}, {}) : fits);
  }

 private:
  static const SessionLocalizer::Config& config() {
    static const SessionLocalizer::Config config = localizer_config();
    return config;
  }
};

TEST_F(AcceptanceTest, TakesTheRightPlaceAtOnce) {
  EXPECT_EQ(said_at_first(landmarks_of_yard(1.0)), "accepted");
}

TEST_F(AcceptanceTest, WantsALongWindowOfARobotWhoseStartIsKnownToMetres) {
  const MapFit fit = fit_of(landmarks_of_yard(1.0));
  const PoseWithCovariance far_from_start{Pose{}, diagonal_covariance(0.09, 2.0)};
  const auto said_with = [&](double window_m) {
    return said(session().confirm(fit, far_from_start, Pose{}, {30.0 - window_m, 30.0}));
  };
  EXPECT_EQ(said_with(5.0), "unconfirmed");
  EXPECT_EQ(said_with(15.0), "accepted");
}

// Half of the walls hidden by things that were put before them.
TEST_F(AcceptanceTest, TakesTheRightPlaceAlthoughMuchIsNew) {
  std::vector<WindowLandmark> landmarks = landmarks_of_yard(1.0);
  for (WindowLandmark& landmark : landmarks) {
    if (number_of(landmark) >= kOnGround && number_of(landmark) % 4 < 2) put_before(landmark, 0.5);
  }
  EXPECT_EQ(said_at_first(landmarks), "accepted");
}

// Beyond the edge of the map: three quarters of what the robot sees were never surveyed.
TEST_F(AcceptanceTest, RefusesAWindowThatIsMostlyOutsideOfTheMap) {
  std::vector<WindowLandmark> landmarks = landmarks_of_yard(1.0);
  for (WindowLandmark& landmark : landmarks) {
    if (number_of(landmark) % 4 != 0) landmark.p_map.x() += 60.0;
  }
  EXPECT_EQ(said_of(landmarks), "not_covered");
}

// Twenty landmarks fit some surface anywhere.
TEST_F(AcceptanceTest, RefusesAHandfulOfLandmarks) {
  std::vector<WindowLandmark> landmarks = landmarks_of_yard(1.0);
  std::erase_if(landmarks, [](const auto& landmark) { return number_of(landmark) % 15 != 0; });
  EXPECT_EQ(said_of(landmarks), "not_covered");
}

TEST_F(AcceptanceTest, RefusesAHandfulOfMatches) {
  std::vector<WindowLandmark> landmarks = landmarks_of_yard(1.0);
  std::erase_if(landmarks, [](const auto& landmark) { return number_of(landmark) < 200; });
  for (WindowLandmark& landmark : landmarks) {
    if (number_of(landmark) % 5 != 0) put_before(landmark, 0.5);
  }
  EXPECT_EQ(said_of(landmarks), "too_few_matches");
}

// As of a robot that was carried away: the older landmarks hold the window where it was.
TEST_F(AcceptanceTest, RefusesAWindowOfWhichWhatWasSeenLastFitsNothing) {
  Acceptance acceptance = session();
  MapFit fit = fit_of(landmarks_of_yard(1.0));
  const auto said_with_recent = [&](const Pose& T_map_seen) {
    fit.recent = fit_of(moved(landmarks_of_yard(1.0), T_map_seen)).association;
    return said(acceptance.check_fit(fit, false));
  };
  const Pose elsewhere{exp_so3({0.0, 0.0, 0.6}), {2.0, 3.0, 0.0}};
  EXPECT_EQ(said_with_recent(Pose{}), "accepted");
  EXPECT_EQ(said_with_recent(elsewhere), "recent_disagreement");
  EXPECT_EQ(said_with_recent({Eigen::Quaterniond::Identity(), {60.0, 0.0, 0.0}}),
            "recent_disagreement")
      << "outside of the map nothing takes it back";
  EXPECT_EQ(said_with_recent(Pose{}), "accepted");
}

// A quarter of the walls is still as in the map.
TEST_F(AcceptanceTest, GetsUsedToASceneThatHasChanged) {
  std::vector<WindowLandmark> changed = landmarks_of_yard(1.0);
  for (WindowLandmark& landmark : changed) {
    if (number_of(landmark) >= kOnGround && number_of(landmark) % 4 != 0) {
      put_before(landmark, 0.5);
    }
  }
  Acceptance acceptance = session();
  MapFit fit = fit_of(landmarks_of_yard(1.0));
  fit.recent = fit.association;
  EXPECT_EQ(said(acceptance.check_fit(fit, false)), "accepted");
  fit.recent = fit_of(changed).association;
  EXPECT_EQ(said(acceptance.check_fit(fit, false)), "recent_disagreement");
  int windows = 1;
  while (!acceptance.check_fit(fit, false)) ASSERT_LT(++windows, 200);
  EXPECT_GT(windows, 20);
}

TEST_F(AcceptanceTest, RefusesAPlaceWhereTheGroundFitsAndNothingElse) {
  EXPECT_EQ(said_of(moved(landmarks_of_yard(1.0), {0.5, 0.5, 0.0})), "disagreement");
}

// Close enough for the gate, but the matches lie beside the walls, not on them.
TEST_F(AcceptanceTest, RefusesAPlaceThatIsNextToTheRightOne) {
  EXPECT_EQ(said_of(moved(landmarks_of_yard(1.0), {0.1, 0.1, 0.0})), "poor_fit");
}

TEST_F(AcceptanceTest, RefusesAWindowThatLiesOnTheSnowBesideAClearedWay) {
  EXPECT_EQ(said_of(moved(landmarks_of_yard(0.3), {0.0, 0.0, -kSnow})), "below_ground");
}

TEST_F(AcceptanceTest, RefusesWhatTheSolverCouldNotSolve) {
  MapFit fit = fit_of(landmarks_of_yard(1.0));
  fit.is_solved = false;
  EXPECT_EQ(said(session().check_fit(fit, false)), "not_solved");
}

TEST_F(AcceptanceTest, RefusesAFirstPlaceThatMovesOnWithEveryRound) {
  MapFit fit = fit_of(landmarks_of_yard(1.0));
  fit.moved_m = 0.03;
  EXPECT_EQ(said(session().check_fit(fit, true)), "not_settled");
  EXPECT_EQ(said(session().check_fit(fit, false)), "accepted") << "the odometry holds it";
}

TEST_F(AcceptanceTest, RefusesAJumpThatTheOdometryDidNotSee) {
  const MapFit fit = fit_at({Eigen::Quaterniond::Identity(), {1.5, 0.0, 0.0}});
  EXPECT_EQ(said(session().check_fit(fit, false)), "innovation");
}

// A seam between two surveys of a map.
TEST_F(AcceptanceTest, TakesASmallStepAndASmallTurnHoweverSureTheOdometryIs) {
  const MapFit step = fit_at({Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.0}});
  EXPECT_EQ(said(session().check_fit(step, false)), "accepted");
  const MapFit turn = fit_at({exp_so3({0.0, 0.0, 0.05}), Eigen::Vector3d::Zero()});
  EXPECT_EQ(said(session().check_fit(turn, false)), "accepted");
}

TEST_F(AcceptanceTest, IsNotLockedOutByItsInnovationGate) {
  Acceptance acceptance = session();
  const MapFit jumped = fit_at({Eigen::Quaterniond::Identity(), {1.5, 0.0, 0.0}});
  int refused = 0;
  while (said(acceptance.check_fit(jumped, false)) == "innovation") ASSERT_LT(++refused, 20);
  EXPECT_GT(refused, 2);
  EXPECT_EQ(said(acceptance.confirm(jumped, kUnknown, Pose{}, {})), "accepted");
  EXPECT_EQ(said(acceptance.check_fit(jumped, false)), "innovation") << "the gate is as before";
}

// Nothing says that the start pose is the one that is wrong.
TEST_F(AcceptanceTest, KeepsToTheStartPoseHoweverOftenItRefuses) {
  Acceptance acceptance = session();
  const MapFit jumped = fit_at({Eigen::Quaterniond::Identity(), {1.5, 0.0, 0.0}});
  for (int i = 0; i < 20; ++i) EXPECT_EQ(said(acceptance.check_fit(jumped, true)), "innovation");
}

TEST_F(AcceptanceTest, RefusesWhatIsNotCertainOrHasNoCovariance) {
  const auto said_of = [this](const std::optional<AnswerCovariance>& stated, bool is_found) {
    return said(session().check_certainty(stated, is_found));
  };
  EXPECT_EQ(said_of(AnswerCovariance{.weak_sigma_m = 0.5}, false), "accepted");
  EXPECT_EQ(said_of(AnswerCovariance{.weak_sigma_m = 2.0}, false), "weak");
  EXPECT_EQ(said_of(std::nullopt, false), "singular");
}

TEST_F(AcceptanceTest, WantsAPlaceThatWasFoundToBeKnownWell) {
  const auto said_of = [this](double sigma_m, bool is_found) {
    const AnswerCovariance stated{.covariance = diagonal_covariance(0.01, sigma_m)};
    return said(session().check_certainty(stated, is_found));
  };
  EXPECT_EQ(said_of(0.8, false), "accepted") << "somebody told where it is";
  EXPECT_EQ(said_of(0.8, true), "weak");
  EXPECT_EQ(said_of(0.3, true), "accepted");
}

// Ground everywhere, but a minority of the landmarks off the ground is on the walls.
TEST_F(AcceptanceTest, WantsAFirstPlaceConfirmedThatFewWallsVouchFor) {
  std::vector<WindowLandmark> landmarks = landmarks_of_yard(1.0);
  for (WindowLandmark& landmark : landmarks) {
    if (number_of(landmark) >= kOnGround && number_of(landmark) % 10 < 6) put_before(landmark, 0.5);
  }
  EXPECT_EQ(said_at_first(landmarks), "unconfirmed");
}

// A wide open place: the few walls all match, but so would a few anywhere.
TEST_F(AcceptanceTest, WantsAFirstPlaceConfirmedThatHasHardlyAnyWalls) {
  std::vector<WindowLandmark> landmarks = landmarks_of_yard(1.0);
  std::erase_if(landmarks, [](const auto& landmark) {
    return number_of(landmark) >= kOnGround && number_of(landmark) % 20 != 0;
  });
  EXPECT_EQ(said_at_first(landmarks), "unconfirmed");
}

// Half of the walls match, but a quarter of the landmarks would be seen through them.
TEST_F(AcceptanceTest, WantsAFirstPlaceConfirmedThatMuchSpeaksAgainst) {
  std::vector<WindowLandmark> landmarks = landmarks_of_yard(1.0);
  std::erase_if(landmarks, [](const auto& landmark) { return number_of(landmark) < kOnGround; });
  for (WindowLandmark& landmark : landmarks) {
    if (number_of(landmark) % 4 == 0) put_before(landmark, 0.5);
    if (number_of(landmark) % 4 == 1) put_before(landmark, -0.5);
  }
  EXPECT_EQ(said_at_first(landmarks), "unconfirmed");
}

TEST(Rejection, HasANameOfItsOwnAndAStatusThatIsARejection) {
  std::set<std::string_view> names;
  for (int i = 0; i <= static_cast<int>(Rejection::kUnconfirmed); ++i) {
    const auto rejection = static_cast<Rejection>(i);
    EXPECT_TRUE(names.insert(name(rejection)).second) << name(rejection);
    EXPECT_NE(status_of(rejection), LocalizationStatus::kLocalized) << name(rejection);
    EXPECT_NE(status_of(rejection), LocalizationStatus::kNeedFull) << name(rejection);
  }
  EXPECT_FALSE(names.contains("unknown"));
}

}  // namespace
}  // namespace fleetloc
