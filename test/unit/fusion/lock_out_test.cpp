// Gates must not lock the truth out for ever, nor let a few wrong answers in.
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
class LockOut : public testing::Test {
 protected:
  LockOut() {
    fed_.drive_to(2.0);
    fed_.answer_at(1.0, elsewhere(3.0));
  }
  PoseFusion::Verdict truth_from(const std::string& localizer, double t) {
    fed_.drive_to(t + 1.0);
    Answer said = answer(t, true_T_map_odom() * fed_.drive.pose(t));
    said.localizer = localizer;
    return fed_.fusion.add_answer(said);
  }
  Quality quality() {
    fed_.drive_to(to_seconds(fed_.output.stamp - Timestamp{}) + 0.01);
    return fed_.output.quality;
  }
  [[nodiscard]] double position_error() const {
    return (fed_.fusion.start_pose()->T_map_odom.p - true_T_map_odom().p).norm();
  }

  FedFusion fed_;
};

TEST_F(LockOut, IndependentAnswersThatAgreeRestartTheAlignment) {
  EXPECT_EQ(truth_from("cloud", 5.0).reason, "gated");
  EXPECT_EQ(truth_from("cloud", 26.0).reason, "gated");
  EXPECT_NE(quality(), Quality::kLost);
  EXPECT_EQ(truth_from("cloud", 47.0).reason, "gated");
  EXPECT_EQ(quality(), Quality::kLost);
  EXPECT_EQ(truth_from("cloud", 68.0).reason, "restarted");
  EXPECT_EQ(quality(), Quality::kLocalized);
  EXPECT_LT(position_error(), 0.05);
}

TEST_F(LockOut, AnswersOfOneWindowCountOnce) {
  for (int i = 0; i < 15; ++i) {
    EXPECT_EQ(truth_from("cloud", 5.0 + i).reason, "gated");
  }
  EXPECT_EQ(quality(), Quality::kLost);
  EXPECT_NEAR(position_error(), 3.0, 0.1);
}

TEST_F(LockOut, ReinitializedLocalizersAreIndependent) {
  EXPECT_EQ(truth_from("a", 5.0).reason, "gated");
  EXPECT_EQ(truth_from("b", 6.0).reason, "gated");
  EXPECT_EQ(truth_from("a", 7.0).reason, "gated");  // the same window again
  EXPECT_EQ(truth_from("c", 8.0).reason, "gated");
  EXPECT_EQ(truth_from("d", 9.0).reason, "restarted");
  EXPECT_LT(position_error(), 0.05);
}

TEST_F(LockOut, AnswersThatDisagreeRestartNothing) {
  for (int i = 0; i < 8; ++i) {
    fed_.drive_to(6.0 + 21.0 * i);
    EXPECT_EQ(fed_.answer_at(5.0 + 21.0 * i, elsewhere(6.0 + 5.0 * i)).reason, "gated");
  }
  EXPECT_EQ(quality(), Quality::kDeadReckoning);
  EXPECT_NEAR(position_error(), 3.0, 0.1);
}

TEST_F(LockOut, AnAppliedAnswerEndsTheContradiction) {
  for (int i = 0; i < 4; ++i) {
    truth_from("cloud", 5.0 + i);
  }
  EXPECT_EQ(quality(), Quality::kLost);
  fed_.drive_to(10.0);
  EXPECT_TRUE(fed_.answer_at(9.5, elsewhere(3.0)).applied);
  EXPECT_EQ(quality(), Quality::kLocalized);
}

}  // namespace
}  // namespace fleetloc
