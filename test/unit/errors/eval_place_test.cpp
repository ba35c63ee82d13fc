#include "deploy/evaluation/errors/eval_place.hpp"

#include <functional>
#include <set>

#include <gtest/gtest.h>

#include "shared/geometry/angle.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr double kRate_hz = 10.0;
constexpr double kSpeed = 2.0;  // [m/s]
constexpr int kDriveFrames = 300;

Timestamp frame_time(int frame) {
  return Timestamp(std::chrono::milliseconds(1'000'000 + 100 * frame));
}

/// A drive along x, ten frames a second, of which estimate and state of each frame can be said.
struct Drive {
  Trajectory truth;
  std::vector<PosePair> poses;
  RunCovariances covariances;

  /// @param from       first frame with a pose in the map
  /// @param localized  whether a frame has that state
  /// @param off_m      error of a frame
  /// @param jump       frame at which the truth is 50 m further on; none: -1
  Drive(int from,
        const std::function<bool(int)>& localized,
        const std::function<double(int)>& off_m,
        int jump = -1) {
    covariances.first_frame = frame_time(0);
    for (int i = 0; i < kDriveFrames; ++i) {
      const double carried_m = jump >= 0 && i >= jump ? 50.0 : 0.0;
      const Pose T{.R = Eigen::Quaterniond::Identity(),
                   .p = {kSpeed * i / kRate_hz + carried_m, 0.0, 0.0}};
      truth.push_back({frame_time(i), T});
      covariances.frames.push_back(frame_time(i));
      if (localized(i)) covariances.localized.push_back(frame_time(i));
      if (i < from) continue;
      poses.push_back(
          {.stamp = frame_time(i),
           .T_truth_body = T,
           .T_estimate_body = {.R = T.R, .p = T.p + off_m(i) * Eigen::Vector3d::UnitY()}});
    }
  }
  [[nodiscard]] nlohmann::json place() const { return first_place(truth, poses, covariances); }
  [[nodiscard]] nlohmann::json carried() const { return carried_away(truth, poses, covariances); }
};

bool always(int) {
  return true;
}
double exact(int) {
  return 0.0;
}

TEST(FirstPlaceOfARun, IsTimedAndMeasuredFromItsFirstFrame) {
  const auto place = Drive(80, always, [](int) { return 0.2; }).place();
  EXPECT_TRUE(place.at("found").get<bool>());
  EXPECT_NEAR(place.at("after_s").get<double>(), 8.0, 1e-6);
  EXPECT_NEAR(place.at("way_m").get<double>(), 16.0, 0.3);
  EXPECT_NEAR(place.at("error_m").get<double>(), 0.2, 1e-9);
  EXPECT_EQ(place.at("wrong_frames"), 0);
}

TEST(FirstPlaceOfARun, IsNotThereWhereTheRobotWasNeverFound) {
  const auto place = Drive(kDriveFrames, always, exact).place();
  EXPECT_FALSE(place.at("found").get<bool>());
  EXPECT_TRUE(place.at("way_m").is_null());
  EXPECT_EQ(place.at("wrong_frames"), 0);
}

TEST(FirstPlaceOfARun, CountsLocalizedFramesAtAWrongPlaceAlone) {
  const auto off = [](int i) { return i < 100 ? 1.1 : 0.9; };
  EXPECT_EQ(Drive(80, always, off).place().at("wrong_frames"), 20);
  EXPECT_EQ(Drive(
                80, [](int i) { return i >= 90; }, off)
                .place()
                .at("wrong_frames"),
            10);
}

TEST(FirstPlaceOfARun, IsWrongWhereItIsTurned) {
  Drive drive(80, always, exact);
  drive.poses[3].T_estimate_body.R = exp_so3({0.0, 0.0, 5.1 * kRadPerDeg});
  drive.poses[4].T_estimate_body.R = exp_so3({0.0, 0.0, 4.9 * kRadPerDeg});
  EXPECT_EQ(drive.place().at("wrong_frames"), 1);
}

TEST(CarriedRobot, IsNoneWithoutAJump) {
  EXPECT_TRUE(Drive(0, always, exact).carried().is_null());
}

TEST(CarriedRobot, IsSureForAWhileThenLostThenRight) {
  // Carried at frame 100, lost from 140 on, right from 200 on.
  const auto localized = [](int i) { return i < 140 || i >= 200; };
  const auto off = [](int i) { return i >= 100 && i < 200 ? 50.0 : 0.0; };
  const auto carried = Drive(0, localized, off, 100).carried();
  EXPECT_NEAR(carried.at("after_s").get<double>(), 10.0, 1e-6);
  EXPECT_NEAR(carried.at("distance_m").get<double>(), 50.2, 1e-6);
  EXPECT_NEAR(carried.at("noticed_s").get<double>(), 4.0, 1e-6);
  EXPECT_NEAR(carried.at("wrong_and_sure_s").get<double>(), 4.0, 1e-6);
  EXPECT_NEAR(carried.at("right_s").get<double>(), 10.0, 1e-6);
  EXPECT_NEAR(carried.at("right_m").get<double>(), 20.0, 0.3);
}

TEST(CarriedRobot, ThatIsSureToTheEndNeverNotices) {
  const auto carried = Drive(
                           0, always, [](int i) { return i < 100 ? 0.0 : 50.0; }, 100)
                           .carried();
  EXPECT_TRUE(carried.at("noticed_s").is_null());
  EXPECT_TRUE(carried.at("right_s").is_null());
  EXPECT_NEAR(carried.at("wrong_and_sure_s").get<double>(), 19.9, 1e-6);
}

}  // namespace
}  // namespace fleetloc
