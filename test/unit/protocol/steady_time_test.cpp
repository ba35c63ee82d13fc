#include "shared/protocol/steady_time.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

TEST(SteadyTime, RunsWithTheClock) {
  SteadyTime time;
  EXPECT_EQ(time(at(100.0)), at(100.0));
  EXPECT_EQ(time(at(100.25)), at(100.25));
  EXPECT_EQ(time(at(101.0)), at(101.0));
}

TEST(SteadyTime, NeitherGoesBackNorLeapsWhenTheClockIsSet) {
  SteadyTime time;
  time(at(100.0));
  EXPECT_EQ(time(at(3600.0)), at(101.0));
  EXPECT_EQ(time(at(3600.5)), at(101.5));
  EXPECT_EQ(time(at(20.0)), at(101.5));
  EXPECT_EQ(time(at(20.25)), at(101.75));
}

}  // namespace
}  // namespace fleetloc
