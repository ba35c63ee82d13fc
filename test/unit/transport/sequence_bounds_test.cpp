#include "shared/transport/workarounds/sequence_bounds.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

class SequenceBoundsTest : public testing::Test {
 protected:
  bool passes(std::int64_t number, std::uint32_t writer = 1) {
    return bounds_.passes(writer, number, now_);
  }

  SequenceBounds bounds_;
  SequenceBounds::Time now_{hours(1000)};
};

TEST_F(SequenceBoundsTest, BelieveTheFirstNumberOfEachWriter) {
  EXPECT_TRUE(passes(1'000'000'000));
  EXPECT_TRUE(passes(5, 2));
}

TEST_F(SequenceBoundsTest, RefuseALeapAndTakeWhatFollowsTheLastOne) {
  ASSERT_TRUE(passes(5));
  EXPECT_FALSE(passes(6 + SequenceBounds::kLeap));
  EXPECT_FALSE(passes(std::int64_t{1} << 60U));
  EXPECT_TRUE(passes(6));
  EXPECT_TRUE(passes(2)) << "late";
  EXPECT_TRUE(passes(6 + SequenceBounds::kLeap));
}

TEST_F(SequenceBoundsTest, GrowWithTheTimeOfAnOutage) {
  ASSERT_TRUE(passes(5));
  now_ += seconds(100);
  EXPECT_FALSE(passes(6 + SequenceBounds::kLeap + 100'000));
  EXPECT_TRUE(passes(5 + SequenceBounds::kLeap + 100'000));
}

TEST_F(SequenceBoundsTest, LeaveWritersBeyondManyAlone) {
  for (std::uint32_t writer = 1; writer <= SequenceBounds::kMaxWriters; ++writer) {
    ASSERT_TRUE(passes(1, writer));
  }
  EXPECT_FALSE(passes(std::int64_t{1} << 60U, 1));
  EXPECT_TRUE(passes(1, 0x10000));
  EXPECT_TRUE(passes(std::int64_t{1} << 60U, 0x10000)) << "of which nothing is remembered";
}

}  // namespace
}  // namespace fleetloc
