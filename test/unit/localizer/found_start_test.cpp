// How long a start pose that was found is believed without a localization.
#include "cloud/localizer/found_start.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

FoundStart found_after_7_m() {
  FoundStart start({.sigma_cells = 2.0,
                    .sigma_rad = 0.05,
                    .shift_steps = 10,
                    .max_way_m = 25.0,
                    .max_misfit_m = 5.0});
  start.find(7.0, 6.0);
  return start;
}

TEST(FoundStart, IsGivenUpWhereNoWindowFits) {
  FoundStart start = found_after_7_m();
  EXPECT_FALSE(start.is_wrong(12.0));
  EXPECT_TRUE(start.is_wrong(12.1));
  start.fit(12.0);
  EXPECT_FALSE(start.is_wrong(17.0));
  EXPECT_TRUE(start.is_wrong(17.1));
}

// As in a corridor, along which everything fits.
TEST(FoundStart, IsGivenUpFromWhichNothingIsLocalizedThoughAllFits) {
  FoundStart start = found_after_7_m();
  for (double travelled_m = 8.0; travelled_m <= 32.0; travelled_m += 1.0) {
    start.fit(travelled_m);
    EXPECT_FALSE(start.is_wrong(travelled_m));
  }
  start.fit(32.1);
  EXPECT_TRUE(start.is_wrong(32.1));
}

TEST(FoundStart, BeginsAnewAtAnotherPlaceOnly) {
  FoundStart start = found_after_7_m();
  EXPECT_EQ(start.searched_m(), 6.0);
  start.find_again(10.0);
  EXPECT_EQ(start.searched_m(), 10.0);
  EXPECT_TRUE(start.is_wrong(12.1));
  start.find(11.0, 8.0);
  EXPECT_EQ(start.searched_m(), 8.0);
  EXPECT_FALSE(start.is_wrong(12.1));
}

TEST(FoundStart, IsNeitherRightNorWrongIfThereIsNone) {
  FoundStart start = found_after_7_m();
  start.give_up();
  start.fit(50.0);
  start.find_again(10.0);
  EXPECT_FALSE(start.exists());
  EXPECT_FALSE(start.is_wrong(100.0));
}

}  // namespace
}  // namespace fleetloc
