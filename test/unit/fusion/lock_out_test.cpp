// Gates must not lock the truth out for ever, nor let a few wrong answers in; and meanwhile no
// wrong pose is given for certain.
#include <gtest/gtest.h>

#include "test/unit/fusion/fed_fusion.hpp"

namespace fleetloc {
namespace {

Pose elsewhere(double x) {
  Pose T = true_T_map_odom();
  T.p.x() += x;
  return T;
}

// Localized where it is not: at `elsewhere(3)`.
class LockOut : public testing::TestWithParam<PoseFusion::Formulation> {
 protected:
  LockOut() : LockOut([](PoseFusion::Config&) {}) {}

  template <typename Change>
  explicit LockOut(const Change& change) : fed_(config(change)) {
    fed_.drive_to(2.0);
    EXPECT_TRUE(fed_.answer_at(1.0, elsewhere(3.0)).has_value());
  }
  AnswerOutcome answer_from(const std::string& localizer, double t, const Pose& T_map_odom) {
    fed_.drive_to(t + 1.0);
    LocalizationResult said = answer(t, T_map_odom * fed_.drive.pose(t));
    said.localizer = localizer;
    return fed_.fusion.add_answer(said);
  }
  AnswerOutcome truth_from(const std::string& localizer, double t) {
    return answer_from(localizer, t, true_T_map_odom());
  }
  AnswerOutcome same_again(double t) { return answer_from("cloud", t, elsewhere(3.0)); }

  Quality quality() {
    fed_.drive_to(to_seconds(fed_.output.stamp - Timestamp{}) + 0.01);
    return fed_.output.quality;
  }
  [[nodiscard]] double position_error() const {
    return (fed_.fusion.session_start()->T_map_odom.p - true_T_map_odom().p).norm();
  }

 private:
  template <typename Change>
  static PoseFusion::Config config(const Change& change) {
    PoseFusion::Config result = fusion_config();
    result.formulation = GetParam();
    change(result);
    return result;
  }

 protected:
  FedFusion fed_;
};

class SoonLost : public LockOut {
 protected:
  SoonLost() : LockOut([](PoseFusion::Config& config) { config.lost_beyond_m = 0.1; }) {}
};

// Answers twice a second: lost within 1.5 s of the first true one, right after the cloud's window.
TEST_P(LockOut, AWrongFirstAnswerIsReplacedAfterOneWindow) {
  constexpr double kFirst = 2.0;
  int rejected = 0;
  double t = kFirst;
  for (; name(truth_from("cloud", t)) == "gated"; t += 0.5) {
    ++rejected;
    EXPECT_EQ(quality(), rejected < 3 ? Quality::kLocalized : Quality::kLost) << "at " << t;
    ASSERT_LT(t, 60.0);
  }
  EXPECT_DOUBLE_EQ(t, kFirst + 20.5);
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_LT(position_error(), 0.05);
}

TEST_P(LockOut, AWrongFirstAnswerIsReplacedSoonerIfWindowsAreShorter) {
  constexpr double kFirst = 2.0;
  double t = kFirst;
  const auto is_gated = [&] {
    fed_.drive_to(t + 1.0);
    LocalizationResult said = answer(t, true_T_map_odom() * fed_.drive.pose(t));
    said.oldest_stamp = at(t - 5.0);
    return name(fed_.fusion.add_answer(said)) == "gated";
  };
  for (; is_gated(); t += 0.5) ASSERT_LT(t, 60.0);
  EXPECT_DOUBLE_EQ(t, kFirst + 5.5);
}

// As the window of a session grows, the localizer sees more than at first. Where it begins is
// rounded twice on its way, to milliseconds.
TEST_P(LockOut, AWrongFirstAnswerYieldsToThreeThatSawAllThatItSaw) {
  const auto truth_of_growing_window = [this](double t) {
    fed_.drive_to(t + 1.0);
    LocalizationResult said = answer(t, true_T_map_odom() * fed_.drive.pose(t));
    said.oldest_stamp = answer(1.0, Pose{}).oldest_stamp + std::chrono::microseconds(1900);
    return name(fed_.fusion.add_answer(said));
  };
  EXPECT_EQ(truth_of_growing_window(2.0), "gated");
  EXPECT_EQ(truth_of_growing_window(2.5), "gated");
  EXPECT_EQ(truth_of_growing_window(3.0), "restarted");
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_LT(position_error(), 0.05);
}

TEST_P(LockOut, WhatEarlierWindowsSawIsNotOutweighedByOneWindow) {
  EXPECT_TRUE(same_again(10.0).has_value());
  for (int i = 0; i < 5; ++i) {
    fed_.drive_to(12.0 + i);
    LocalizationResult said = answer(11.0 + i, true_T_map_odom() * fed_.drive.pose(11.0 + i));
    said.oldest_stamp = answer(10.0, Pose{}).oldest_stamp;
    EXPECT_EQ(name(fed_.fusion.add_answer(said)), "gated");
  }
}

TEST_P(LockOut, AnAlignmentThatManyWindowsConfirmedYieldsToMany) {
  for (int i = 1; i < 5; ++i) {
    EXPECT_TRUE(same_again(1.0 + 21.0 * i).has_value());
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(name(truth_from("cloud", 90.0 + 21.0 * i)), "gated");
  }
  EXPECT_EQ(quality(), Quality::kLost);
  EXPECT_EQ(name(truth_from("cloud", 153.0)), "restarted");
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_LT(position_error(), 0.05);
}

TEST_P(LockOut, AReplacementKeepsTheStandingOfItsAnswers) {
  truth_from("cloud", 5.0);
  EXPECT_EQ(name(truth_from("cloud", 26.0)), "restarted");
  EXPECT_EQ(name(same_again(27.0)), "gated");
  EXPECT_EQ(name(same_again(48.0)), "gated");  // two against two
  EXPECT_EQ(name(same_again(69.0)), "restarted");
}

TEST_P(LockOut, AnswersOfOneWindowCountOnce) {
  for (int i = 0; i < 15; ++i) {
    EXPECT_EQ(name(truth_from("cloud", 5.0 + i)), "gated");
  }
  EXPECT_EQ(quality(), Quality::kLost);
  EXPECT_NEAR(position_error(), 3.0, 0.1);
}

TEST_P(LockOut, ReinitializedLocalizersAreIndependent) {
  EXPECT_EQ(name(truth_from("a", 5.0)), "gated");
  EXPECT_EQ(name(truth_from("a", 6.0)), "gated");  // the same window again
  EXPECT_EQ(name(truth_from("b", 7.0)), "restarted");
  EXPECT_LT(position_error(), 0.05);
}

TEST_P(LockOut, AnswersThatDisagreeRestartNothing) {
  for (int i = 0; i < 8; ++i) {
    fed_.drive_to(6.0 + 21.0 * i);
    EXPECT_EQ(name(fed_.answer_at(5.0 + 21.0 * i, elsewhere(6.0 + 5.0 * i))), "gated");
  }
  EXPECT_EQ(quality(), Quality::kDeadReckoning);
  EXPECT_NEAR(position_error(), 3.0, 0.1);
}

// So outliers without end take a bounded place. Compare AReplacementKeepsTheStandingOfItsAnswers.
TEST_P(LockOut, OutliersPushOutTheOldestAlternative) {
  truth_from("cloud", 5.0);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(name(answer_from("cloud", 6.0 + i, elsewhere(8.0 + 5.0 * i))), "gated");
  }
  EXPECT_EQ(name(truth_from("cloud", 26.0)), "gated");
}

TEST_P(LockOut, AppliedAnswersInARowEndTheContradiction) {
  for (int i = 0; i < 4; ++i) {
    truth_from("cloud", 5.0 + i);
  }
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(quality(), Quality::kLost);
    EXPECT_TRUE(same_again(9.0 + i).has_value());
  }
  EXPECT_EQ(quality(), Quality::kLocalized);
}

TEST_P(LockOut, IsLostWhileHalfOfTheAnswersContradict) {
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(name(truth_from("cloud", 3.0 + i)), "gated");
    EXPECT_EQ(quality(), i < 2 ? Quality::kLocalized : Quality::kLost) << i;
    EXPECT_TRUE(same_again(3.5 + i).has_value());
    EXPECT_EQ(quality(), i < 2 ? Quality::kLocalized : Quality::kLost) << i;
  }
}

// Another localizer that starts there must be able to find the truth.
TEST_P(LockOut, TheStartPoseReachesToWhatContradictsIt) {
  const auto deviations_from_truth = [this] {
    const MapOdomEstimate start = *fed_.fusion.session_start();
    const Vector6d error = local_coordinates(start.T_map_odom, true_T_map_odom());
    return std::sqrt(error.dot(start.covariance.llt().solve(error)));
  };
  EXPECT_GT(deviations_from_truth(), 10.0);
  for (int i = 0; i < 3; ++i) {
    truth_from("cloud", 5.0 + i);
  }
  EXPECT_LT(deviations_from_truth(), 1.1);
}

// A map of another content says nothing about the pose in this one, so it contradicts nothing; nor
// does it keep the pose from drifting.
TEST_P(SoonLost, AnotherMapIsRefusedUntilTheSessionEnds) {
  constexpr MapHash kOther{7};
  const auto other_map = [&](double t, SessionNumber session) {
    fed_.drive_to(t + 1.0);
    LocalizationResult said = answer(t, true_T_map_odom() * fed_.drive.pose(t));
    said.map_hash = kOther;
    said.session = session;
    return fed_.fusion.add_answer(said);
  };
  bool dead_reckoned = false;
  for (int second = 2; second < 180; second += 2) {
    const double t = second;
    EXPECT_EQ(name(other_map(t, SessionNumber{})), "wrong_map");
    EXPECT_EQ(quality() == Quality::kLocalized, t < 30.0) << t;
    dead_reckoned = dead_reckoned || quality() == Quality::kDeadReckoning;
  }
  EXPECT_TRUE(dead_reckoned);
  EXPECT_EQ(quality(), Quality::kLost);

  fed_.fusion.reset(SessionNumber{1}, std::nullopt);
  fed_.drive_to(183.0);
  EXPECT_EQ(name(other_map(183.0, SessionNumber{1})), "applied");
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_LT(position_error(), 0.05);
}

LocalizationResult lost(LocalizationResult said) {
  said.status = LocalizationStatus::kLost;
  return said;
}

// Two answers to one frame, in either order: the one of the newer revision counts.
TEST_P(LockOut, APlaceThatIsTakenBackIsNotGivenAgainByAnOlderAnswerToTheSameFrame) {
  fed_.drive_to(66.0);
  LocalizationResult older = answer(65.0, elsewhere(3.0) * fed_.drive.pose(65.0));
  LocalizationResult newer = lost(older);
  newer.revision = Revision{static_cast<std::uint32_t>(older.revision) + 1};
  EXPECT_TRUE(fed_.fusion.add_answer(older));
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_EQ(name(fed_.fusion.add_answer(newer)), "not_localized");
  EXPECT_EQ(quality(), Quality::kLost);
  EXPECT_EQ(name(fed_.fusion.add_answer(older)), "older_than_applied");
  EXPECT_EQ(quality(), Quality::kLost);
  older.revision = Revision{static_cast<std::uint32_t>(older.revision) + 2};
  EXPECT_TRUE(fed_.fusion.add_answer(older));
  EXPECT_EQ(name(fed_.fusion.add_answer(newer)), "not_localized");
  EXPECT_EQ(quality(), Quality::kLocalized);
}

// The search for a robot that is lost ends between its keyframes, or while it stands: the newest
// one is answered again as it is.
TEST_P(LockOut, APlaceThatIsFoundForTheFrameOfTheLossCounts) {
  fed_.drive_to(66.0);
  LocalizationResult found = answer(65.0, true_T_map_odom() * fed_.drive.pose(65.0));
  found.number = 7;
  LocalizationResult before = lost(found);
  before.number = 6;
  EXPECT_EQ(name(fed_.fusion.add_answer(before)), "not_localized");
  EXPECT_EQ(quality(), Quality::kLost);
  EXPECT_TRUE(fed_.fusion.add_answer(found));
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_EQ(name(fed_.fusion.add_answer(before)), "not_localized");
  EXPECT_EQ(quality(), Quality::kLocalized);
}

// A robot that is placed has another session, which answers to the frames that it has.
TEST_P(LockOut, ALossOfTheSessionBeforeDoesNotOutrankTheAnswersOfTheNext) {
  fed_.drive_to(66.0);
  LocalizationResult said = answer(65.0, true_T_map_odom() * fed_.drive.pose(65.0));
  LocalizationResult before = lost(said);
  before.revision = Revision{static_cast<std::uint32_t>(said.revision) + 1};
  EXPECT_EQ(name(fed_.fusion.add_answer(before)), "not_localized");
  fed_.fusion.forget_map(SessionNumber{1});
  said.session = SessionNumber{1};
  EXPECT_TRUE(fed_.fusion.add_answer(said));
  EXPECT_EQ(quality(), Quality::kLocalized);
}

// Whatever had confirmed the place before: as after somebody carried the robot away.
TEST_P(LockOut, APlaceThatTheLocalizerTakesBackYieldsToItsNextAnswer) {
  for (int i = 1; i < 4; ++i) EXPECT_TRUE(same_again(21.0 * i).has_value());
  fed_.drive_to(66.0);
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_EQ(name(fed_.fusion.add_answer(lost(answer(65.0, Pose{})))), "not_localized");
  EXPECT_EQ(quality(), Quality::kLost);
  const Matrix6d anywhere = fed_.fusion.session_start()->covariance;
  EXPECT_GT(anywhere.diagonal().tail<3>().minCoeff(), 500.0 * 500.0);
  EXPECT_EQ(name(truth_from("cloud", 70.0)), "restarted");
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_LT(position_error(), 0.05);
}

TEST_P(LockOut, APlaceThatWasTakenBackIsGivenAgainByAnAnswerThatAgrees) {
  fed_.drive_to(6.0);
  fed_.fusion.add_answer(lost(answer(5.0, Pose{})));
  EXPECT_EQ(quality(), Quality::kLost);
  EXPECT_EQ(name(same_again(7.0)), "applied");
  EXPECT_EQ(quality(), Quality::kLocalized);
  fed_.fusion.add_answer(lost(answer(6.0, Pose{})));
  EXPECT_EQ(quality(), Quality::kLocalized) << "it is older than what came before it";
  LocalizationResult of_another_session = lost(answer(7.0, Pose{}));
  of_another_session.session = SessionNumber{3};
  fed_.fusion.reset(SessionNumber{1}, fed_.fusion.session_start());
  fed_.drive_to(9.0);
  fed_.fusion.add_answer(of_another_session);
  EXPECT_NE(quality(), Quality::kLost);
}

TEST_P(LockOut, ARobotThatMayBeAnywhereIsLostUntilTheNextAnswer) {
  fed_.drive_to(6.0);
  fed_.fusion.lose();
  EXPECT_EQ(quality(), Quality::kLost);
  EXPECT_EQ(name(truth_from("cloud", 7.0)), "restarted");
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_LT(position_error(), 0.05);
}

TEST_P(SoonLost, WhatDriftedTooFarIsFoundAgainByOneAnswer) {
  fed_.drive_to(180.0);
  EXPECT_EQ(fed_.output.quality, Quality::kLost);
  EXPECT_TRUE(same_again(179.0).has_value());
  EXPECT_EQ(quality(), Quality::kLocalized);
}

constexpr auto kFormulation = [](const auto& info) {
  return info.param == PoseFusion::Formulation::kDecoupled ? "Decoupled" : "Coupled";
};
const auto kBoth =
    testing::Values(PoseFusion::Formulation::kDecoupled, PoseFusion::Formulation::kCoupled);
// Whatever had confirmed the place before the robot was blind. (In the coupled filter the IMU
// bridges the stretch.)
TEST(LockOutAfterABlindStretch, AWrongAnswerYieldsToThreeThatSawAllThatItSaw) {
  FedFusion fed;
  const auto said = [&fed](double t, double oldest, double off_m) {
    fed.drive_to(t + 1.0);
    Pose T_map_odom = true_T_map_odom();
    T_map_odom.p.x() += off_m;
    LocalizationResult result = answer(t, T_map_odom * fed.drive.pose(t));
    result.oldest_stamp = at(oldest);
    return name(fed.fusion.add_answer(result));
  };
  for (const double t : {21.0, 42.0, 63.0, 84.0}) EXPECT_EQ(said(t, t - kWindow, 0.0), "applied");
  fed.drive_to(86.0);
  OdometryEstimate uncertain = odometry(85.97, fed.drive.state(85.97));
  uncertain.covariance.diagonal().segment<3>(3).setConstant(0.09);
  EXPECT_TRUE(fed.fusion.add_odometry(uncertain));
  EXPECT_EQ(said(87.0, 86.0, 0.4), "applied");
  EXPECT_EQ(said(87.5, 86.0, 0.0), "gated");
  EXPECT_EQ(said(88.0, 86.0, 0.0), "gated");
  EXPECT_EQ(said(88.5, 86.0, 0.0), "restarted");
}

INSTANTIATE_TEST_SUITE_P(Fusion, LockOut, kBoth, kFormulation);
INSTANTIATE_TEST_SUITE_P(Fusion, SoonLost, kBoth, kFormulation);

}  // namespace
}  // namespace fleetloc
