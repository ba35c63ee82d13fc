// How long a start pose that was found is believed without a localization.
#include "cloud/localizer/found_start.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

FoundStart found_after_7_m() {
  FoundStart start(
      {.sigma_cells = 2.0, .sigma_rad = 0.05, .max_way_m = 25.0, .max_refused_way_m = 5.0});
  start.begin(7.0, 6.0);
  return start;
}

TEST(FoundStart, IsGivenUpWhereAllWindowsSpeakAgainstIt) {
  FoundStart start = found_after_7_m();
  start.judge(PlaceEvidence::kAgainst, 8.0);
  start.judge(PlaceEvidence::kAgainst, 12.0);
  EXPECT_FALSE(start.is_wrong(13.0));
  EXPECT_TRUE(start.is_wrong(13.1));
  start.judge(PlaceEvidence::kFor, 13.0);
  EXPECT_FALSE(start.is_wrong(13.1));
  start.judge(PlaceEvidence::kAgainst, 14.0);
  EXPECT_FALSE(start.is_wrong(19.0));
  EXPECT_TRUE(start.is_wrong(19.1));
}

// As after a gap of the network, and at the edge of the map.
TEST(FoundStart, IsNotGivenUpBecauseNothingIsSaidOfIt) {
  FoundStart start = found_after_7_m();
  EXPECT_FALSE(start.is_wrong(20.0));
  for (double travelled_m = 20.0; travelled_m <= 30.0; travelled_m += 1.0) {
    start.judge(PlaceEvidence::kNone, travelled_m);
    EXPECT_FALSE(start.is_wrong(travelled_m));
  }
}

// As in a corridor, along which everything fits.
TEST(FoundStart, IsGivenUpFromWhichNothingIsLocalizedThoughAllFits) {
  FoundStart start = found_after_7_m();
  for (double travelled_m = 8.0; travelled_m <= 32.0; travelled_m += 1.0) {
    start.judge(PlaceEvidence::kFor, travelled_m);
    EXPECT_FALSE(start.is_wrong(travelled_m));
  }
  EXPECT_TRUE(start.is_wrong(32.1));
}

TEST(FoundStart, IsKnownFromTheLongestWindowAndBeginsAnewAtAnotherPlaceOnly) {
  FoundStart start = found_after_7_m();
  EXPECT_EQ(start.searched_m(), 6.0);
  EXPECT_TRUE(start.confirm(10.0));
  EXPECT_FALSE(start.confirm(9.0));
  EXPECT_FALSE(start.confirm(10.0));
  EXPECT_EQ(start.searched_m(), 10.0);
  EXPECT_TRUE(start.is_wrong(32.1));
  start.begin(11.0, 8.0);
  EXPECT_EQ(start.searched_m(), 8.0);
  EXPECT_FALSE(start.is_wrong(32.1));
}

TEST(FoundStart, IsNeitherRightNorWrongIfThereIsNone) {
  FoundStart start = found_after_7_m();
  start.give_up();
  start.judge(PlaceEvidence::kAgainst, 8.0);
  EXPECT_FALSE(start.confirm(10.0));
  EXPECT_FALSE(start.exists());
  EXPECT_FALSE(start.is_wrong(100.0));
}

}  // namespace
}  // namespace fleetloc
