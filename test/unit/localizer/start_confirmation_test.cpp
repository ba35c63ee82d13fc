#include <gtest/gtest.h>

#include "cloud/localizer/acceptance.hpp"
#include "shared/geometry/covariance.hpp"
#include "shared/geometry/so3.hpp"
#include "simulated_session.hpp"

namespace fleetloc {
namespace {

// The values that ship: 15 m within 0.2 m.
StartConfirmation session() {
  return StartConfirmation(localizer_config().confirmation);
}

Pose placed_at(double x, double y) {
  return {Eigen::Quaterniond::Identity(), {x, y, 0.0}};
}

TEST(StartConfirmation, IsImmediateWhereTheMapAgrees) {
  StartConfirmation start = session();
  EXPECT_TRUE(start.take(placed_at(7.0, 0.0), placed_at(0.0, 0.0), 0.0, true));
  EXPECT_TRUE(start.take(placed_at(8.0, 5.0), placed_at(1.0, 0.0), 1.0, false)) << "and final";
}

TEST(StartConfirmation, TakesAPathWhereTheMapHardlyAgrees) {
  StartConfirmation start = session();
  for (int metre = 0; metre < 15; ++metre) {
    const double x = metre;
    EXPECT_FALSE(start.take(placed_at(7.0 + x, 0.1), placed_at(x, 0.0), x, false)) << x;
  }
  EXPECT_TRUE(start.take(placed_at(22.0, 0.0), placed_at(15.0, 0.0), 15.0, false));
}

TEST(StartConfirmation, NeverComesToARobotThatStands) {
  StartConfirmation start = session();
  for (int i = 0; i < 1000; ++i)
    EXPECT_FALSE(start.take(placed_at(7.0, 0.0), placed_at(0.0, 0.0), 0.0, false));
}

TEST(StartConfirmation, BeginsAnewWhenThePlaceMoves) {
  StartConfirmation start = session();
  EXPECT_FALSE(start.take(placed_at(7.0, 0.0), placed_at(0.0, 0.0), 0.0, false));
  EXPECT_FALSE(start.take(placed_at(17.0, 0.0), placed_at(10.0, 0.0), 10.0, false));
  EXPECT_FALSE(start.take(placed_at(23.0, 0.3), placed_at(16.0, 0.0), 16.0, false))
      << "moved by 0.3 m";
  EXPECT_FALSE(start.take(placed_at(33.0, 0.3), placed_at(26.0, 0.0), 26.0, false));
  EXPECT_TRUE(start.take(placed_at(38.0, 0.3), placed_at(31.0, 0.0), 31.0, false));
}

// A wrong heading is a place that moves as the robot drives on.
TEST(StartConfirmation, BeginsAnewWhenTheHeadingWasWrong) {
  StartConfirmation start = session();
  const Pose T_map_odom{exp_so3({0.0, 0.0, 0.05}), Eigen::Vector3d::Zero()};
  EXPECT_FALSE(start.take(T_map_odom * placed_at(0.0, 0.0), placed_at(0.0, 0.0), 0.0, false));
  EXPECT_FALSE(start.take(placed_at(15.0, 0.0), placed_at(15.0, 0.0), 15.0, false))
      << "0.75 m beside";
}

// As after 30 m from a start that was turned by some degrees, before anybody answered.
TEST(StartConfirmation, NeedsALongWindowWhereTheStartPoseLeavesRoomForOtherPlaces) {
  const StartConfirmation start = session();
  const auto with_sigma = [](double m) {
    return PoseWithCovariance{placed_at(7.0, 0.0), diagonal_covariance(0.09, m)};
  };
  const auto window_of = [](double m) {
    return TravelledPath{.to_oldest_m = 2.0, .to_newest_m = 2.0 + m};
  };
  EXPECT_TRUE(start.is_distinct(with_sigma(0.9), window_of(1.0)));
  EXPECT_FALSE(start.is_distinct(with_sigma(1.1), window_of(14.0)));
  EXPECT_TRUE(start.is_distinct(with_sigma(1.1), window_of(15.0)));
}

// As a place 240 m off that was the only one after 8 m, and fitted until the robot had driven 15 m.
TEST(StartConfirmation, NeedsAPlaceThatIsFoundAgainFromALongerWindow) {
  const StartConfirmation start = session();
  const auto is_found_well = [&start](double sigma_m, double searched_m) {
    return start.is_found_well({placed_at(7.0, 0.0), diagonal_covariance(0.09, sigma_m)},
                               {.to_oldest_m = 0.0, .to_newest_m = 16.0, .searched_m = searched_m});
  };
  EXPECT_FALSE(is_found_well(1.2, 9.0));
  EXPECT_TRUE(is_found_well(1.2, 10.0));
  EXPECT_TRUE(is_found_well(0.6, 2.0)) << "in a room";
}

// A robot that comes from another localizer has to drive nowhere first.
TEST(StartConfirmation, IsImmediateWhereACertainStartPoseSaysTheSame) {
  const StartConfirmation start = session();
  const auto with_sigmas = [](double rad, double m) {
    return PoseWithCovariance{placed_at(7.0, 0.0), diagonal_covariance(rad, m)};
  };
  EXPECT_TRUE(start.is_vouched_for(with_sigmas(0.005, 0.05), placed_at(7.1, 0.0)));
  EXPECT_FALSE(start.is_vouched_for(with_sigmas(0.005, 0.05), placed_at(7.3, 0.0)))
      << "another place";
  EXPECT_FALSE(start.is_vouched_for(with_sigmas(0.005, 0.5), placed_at(7.1, 0.0))) << "set by hand";
  EXPECT_FALSE(start.is_vouched_for(with_sigmas(0.09, 0.05), placed_at(7.1, 0.0))) << "the same";
}

}  // namespace
}  // namespace fleetloc
