#include "cloud/localizer/place_doubt.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

constexpr PlaceDoubt::Config kDoubt{.way_m = 8.0,
                                    .start_way_m = 25.0,
                                    .min_agreement = 0.5,
                                    .sure_agreement = 0.75,
                                    .min_landmarks = 10};

// Of a session that was localized at the beginning of its way.
PlaceDoubt doubt_of_localized() {
  PlaceDoubt doubt(kDoubt);
  doubt.take(std::nullopt, 0.0);
  return doubt;
}

TEST(PlaceDoubt, ComesWithAWayOverWhichNothingFits) {
  PlaceDoubt doubt = doubt_of_localized();
  for (double way_m = 1.0; way_m < 9.0; ++way_m) {
    doubt.take(Rejection::kRecentDisagreement, way_m);
    EXPECT_FALSE(doubt.is_lost()) << way_m;
  }
  doubt.take(Rejection::kDisagreement, 9.0);
  EXPECT_TRUE(doubt.is_lost());
}

Association recent(int matches, int covered) {
  Association result;
  result.matches.resize(static_cast<std::size_t>(matches));
  result.covered = result.eligible = covered;
  return result;
}

TEST(PlaceDoubt, WantsWhatWasSeenLastToFitAsItUsedTo) {
  PlaceDoubt doubt = doubt_of_localized();
  EXPECT_FALSE(doubt.is_elsewhere(recent(16, 20)));
  EXPECT_FALSE(doubt.is_elsewhere(recent(9, 20)));
  EXPECT_TRUE(doubt.is_elsewhere(recent(7, 20)));
  EXPECT_TRUE(doubt.is_elsewhere(recent(9, 9))) << "too few to take it back";
  EXPECT_FALSE(doubt.is_elsewhere(recent(9, 20)));
  doubt.take(Rejection::kRecentDisagreement, 1.0);
  doubt.take(Rejection::kRecentDisagreement, 9.0);
  EXPECT_TRUE(doubt.is_elsewhere(recent(9, 20))) << "chance may fit as much";
  EXPECT_FALSE(doubt.is_elsewhere(recent(14, 20)));
}

TEST(PlaceDoubt, NeverComesToARobotThatStands) {
  PlaceDoubt doubt = doubt_of_localized();
  for (int i = 0; i < 1000; ++i) doubt.take(Rejection::kDisagreement, 1.0);
  EXPECT_FALSE(doubt.is_lost());
}

TEST(PlaceDoubt, BeginsAnewWhereAWindowFits) {
  PlaceDoubt doubt = doubt_of_localized();
  doubt.take(Rejection::kDisagreement, 1.0);
  doubt.take(Rejection::kWeak, 7.0);
  doubt.take(Rejection::kDisagreement, 9.0);
  doubt.take(Rejection::kDisagreement, 16.0);
  EXPECT_FALSE(doubt.is_lost());
  doubt.take(Rejection::kDisagreement, 17.0);
  EXPECT_TRUE(doubt.is_lost());
}

// Of what a robot sees at a wrong place, half as much fits as usual by chance.
TEST(PlaceDoubt, IsNotTakenBackByWhatChanceFits) {
  PlaceDoubt doubt = doubt_of_localized();
  EXPECT_FALSE(doubt.is_elsewhere(recent(18, 20)));
  EXPECT_TRUE(doubt.is_elsewhere(recent(8, 20)));
  doubt.take(Rejection::kRecentDisagreement, 1.0);
  EXPECT_FALSE(doubt.is_elsewhere(recent(10, 20)));
  doubt.take(std::nullopt, 5.0);
  EXPECT_TRUE(doubt.is_elsewhere(recent(8, 20)));
  doubt.take(Rejection::kRecentDisagreement, 9.0);
  EXPECT_TRUE(doubt.is_lost());
}

// Outside of the map, and where submaps were lost.
TEST(PlaceDoubt, IsNotMovedByWhatSaysNothing) {
  PlaceDoubt doubt = doubt_of_localized();
  for (double way_m = 1.0; way_m < 100.0; ++way_m) {
    doubt.take(Rejection::kNotCovered, way_m);
    doubt.take(Rejection::kTooFewKeyframes, way_m);
  }
  EXPECT_FALSE(doubt.is_lost());
}

TEST(PlaceDoubt, EndsWithALocalizationAndNothingLess) {
  PlaceDoubt doubt = doubt_of_localized();
  doubt.take(Rejection::kPoorFit, 1.0);
  doubt.take(Rejection::kPoorFit, 9.0);
  ASSERT_TRUE(doubt.is_lost());
  doubt.take(Rejection::kUnconfirmed, 10.0);
  doubt.take(Rejection::kNotCovered, 11.0);
  EXPECT_TRUE(doubt.is_lost());
  doubt.take(std::nullopt, 12.0);
  EXPECT_FALSE(doubt.is_lost());
}

TEST(PlaceDoubt, GivesAStartPoseMoreTime) {
  PlaceDoubt doubt(kDoubt);
  doubt.take(Rejection::kNotSettled, 2.0);
  doubt.take(Rejection::kDisagreement, 26.0);
  EXPECT_FALSE(doubt.is_lost());
  doubt.take(Rejection::kDisagreement, 27.0);
  EXPECT_TRUE(doubt.is_lost());
}

}  // namespace
}  // namespace fleetloc
