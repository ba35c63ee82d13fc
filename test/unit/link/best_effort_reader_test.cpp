#include "shared/link/best_effort_reader.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

TEST(BestEffortReader, GivesOutNewerAndNewerSamplesOnly) {
  BestEffortReader reader;
  EXPECT_TRUE(reader.receive(1, 0, 1));
  EXPECT_TRUE(reader.receive(4, 0, 1)) << "others are lost";
  EXPECT_FALSE(reader.receive(4, 0, 1)) << "a duplicate";
  EXPECT_FALSE(reader.receive(3, 0, 1)) << "behind a newer one";
  EXPECT_TRUE(reader.receive(5, 0, 1));
}

TEST(BestEffortReader, PutsFragmentsTogetherInAnyOrder) {
  BestEffortReader reader;
  EXPECT_FALSE(reader.receive(1, 2, 3));
  EXPECT_FALSE(reader.receive(1, 0, 3));
  EXPECT_FALSE(reader.receive(1, 0, 3)) << "a duplicate";
  EXPECT_TRUE(reader.receive(1, 1, 3));
  EXPECT_FALSE(reader.receive(1, 1, 3)) << "a duplicate";
  EXPECT_TRUE(reader.receive(2, 0, 1));
}

TEST(BestEffortReader, GivesUpASampleForAFragmentOfANewerOne) {
  BestEffortReader reader;
  EXPECT_FALSE(reader.receive(1, 0, 2));
  EXPECT_FALSE(reader.receive(2, 0, 2));
  EXPECT_FALSE(reader.receive(1, 1, 2));
  EXPECT_TRUE(reader.receive(2, 1, 2));
  EXPECT_FALSE(reader.receive(1, 0, 2));
}

TEST(BestEffortReader, GivesOutAnOlderSampleOfOneDatagramWhileItHoldsFragments) {
  BestEffortReader reader;
  EXPECT_FALSE(reader.receive(2, 0, 2));
  EXPECT_TRUE(reader.receive(1, 0, 1));
  EXPECT_TRUE(reader.receive(2, 1, 2));
}

TEST(BestEffortReader, DropsTheFragmentsOfASampleThatWasOvertakenAsAWhole) {
  BestEffortReader reader;
  EXPECT_FALSE(reader.receive(1, 0, 2));
  EXPECT_TRUE(reader.receive(2, 0, 1));
  EXPECT_FALSE(reader.receive(1, 1, 2));
  EXPECT_FALSE(reader.receive(3, 0, 2));
  EXPECT_TRUE(reader.receive(3, 1, 2));
}

}  // namespace
}  // namespace fleetloc
