#include "shared/protocol/status_timer.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

TEST(StatusTimer, IsDueAtOnceThenSeldomAndSoonAfterAChange) {
  StatusTimer timer({.interval_s = 10.0, .min_interval_s = 1.0});
  EXPECT_TRUE(timer.due(at(0), false));
  EXPECT_FALSE(timer.due(at(9.9), false));
  EXPECT_TRUE(timer.due(at(10), false));
  EXPECT_FALSE(timer.due(at(10.9), true)) << "not so soon";
  EXPECT_TRUE(timer.due(at(11), true));
  EXPECT_FALSE(timer.due(at(20.9), false));
  EXPECT_TRUE(timer.due(at(21), false));
  timer.reset();
  EXPECT_TRUE(timer.due(at(21.1), false));
}

}  // namespace
}  // namespace fleetloc
