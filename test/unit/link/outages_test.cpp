#include "shared/link/outages.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Outages, LastFromTheirStartForTheirLength) {
  const Outages outages{.at = {{.from_s = 10.0, .for_s = 2.0}, {.from_s = 30.0, .for_s = 0.5}}};
  EXPECT_FALSE(is_out({}, seconds(10)));
  EXPECT_FALSE(is_out(outages, milliseconds(9999)));
  EXPECT_TRUE(is_out(outages, seconds(10)));
  EXPECT_TRUE(is_out(outages, milliseconds(11'999)));
  EXPECT_FALSE(is_out(outages, seconds(12)));
  EXPECT_TRUE(is_out(outages, milliseconds(30'400)));
  EXPECT_FALSE(is_out(outages, milliseconds(30'500)));
}

TEST(Outages, RecurWithTheirPeriod) {
  const Outages outages{.periodic = {.every_s = 60.0, .from_s = 20.0, .for_s = 5.0}};
  EXPECT_FALSE(is_out(outages, seconds(0)));
  EXPECT_FALSE(is_out(outages, seconds(19)));
  for (const int period : {0, 1, 1000}) {
    EXPECT_TRUE(is_out(outages, seconds(20 + 60 * period)));
    EXPECT_TRUE(is_out(outages, seconds(24 + 60 * period)));
    EXPECT_FALSE(is_out(outages, seconds(25 + 60 * period)));
    EXPECT_FALSE(is_out(outages, seconds(79 + 60 * period)));
  }
}

TEST(Outages, MayBeOfBothKinds) {
  const Outages outages{.at = {{.from_s = 3.0, .for_s = 1.0}},
                        .periodic = {.every_s = 10.0, .from_s = 0.0, .for_s = 1.0}};
  EXPECT_TRUE(is_out(outages, seconds(0)));
  EXPECT_FALSE(is_out(outages, seconds(2)));
  EXPECT_TRUE(is_out(outages, seconds(3)));
  EXPECT_FALSE(is_out(outages, seconds(13)));
}

}  // namespace
}  // namespace fleetloc
