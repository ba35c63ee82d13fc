#include "cloud/pool/waiting_submaps.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

constexpr WaitingSubmaps::Limits kLimits{.max_submaps = 3, .max_bytes = 1000};

Submap submap(std::uint32_t number) {
  Submap result;
  result.number = SampleNumber{number};
  return result;
}

TEST(WaitingSubmaps, AreTakenInTheOrderInWhichTheyCame) {
  WaitingSubmaps waiting;
  for (std::uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(waiting.push(submap(i), 10, at(static_cast<int>(i)), kLimits), 0);
  }
  EXPECT_EQ(waiting.oldest(), at(0));
  const auto taken = waiting.take();
  ASSERT_EQ(taken.size(), 3);
  EXPECT_EQ(taken[0].number, SampleNumber{0});
  EXPECT_EQ(taken[2].number, SampleNumber{2});
  EXPECT_TRUE(waiting.take().empty());
}

TEST(WaitingSubmaps, ThatAreSetAsideAreTakenWithTheNextAndNoLongerCountAsWaiting) {
  WaitingSubmaps waiting;
  waiting.push(submap(0), 10, at(0), kLimits);
  waiting.push(submap(1), 10, at(1), kLimits);
  EXPECT_EQ(waiting.set_aside(), 2);
  EXPECT_EQ(waiting.set_aside(), 0);
  waiting.push(submap(2), 10, at(9), kLimits);
  EXPECT_EQ(waiting.oldest(), at(9));
  EXPECT_EQ(waiting.take().size(), 3);
}

TEST(WaitingSubmaps, TellWhetherThereIsRoom) {
  WaitingSubmaps waiting;
  EXPECT_TRUE(waiting.has_room(5000, kLimits)) << "a single one may have more";
  waiting.push(submap(0), 600, at(0), kLimits);
  EXPECT_FALSE(waiting.has_room(500, kLimits));
  EXPECT_TRUE(waiting.has_room(400, kLimits));
  waiting.push(submap(1), 10, at(0), kLimits);
  waiting.push(submap(2), 10, at(0), kLimits);
  EXPECT_FALSE(waiting.has_room(1, kLimits));
}

TEST(WaitingSubmaps, DropTheOldestOfTooMany) {
  WaitingSubmaps waiting;
  for (std::uint32_t i = 0; i < 3; ++i) waiting.push(submap(i), 10, at(0), kLimits);
  EXPECT_EQ(waiting.push(submap(3), 10, at(1), kLimits), 1);
  EXPECT_EQ(waiting.take().front().number, SampleNumber{1});
}

TEST(WaitingSubmaps, DropTheOldestOfTooManyBytesButKeepTheNewest) {
  WaitingSubmaps waiting;
  waiting.push(submap(0), 600, at(0), kLimits);
  EXPECT_EQ(waiting.push(submap(1), 600, at(1), kLimits), 1);
  EXPECT_EQ(waiting.push(submap(2), 5000, at(2), kLimits), 1);
  EXPECT_EQ(waiting.clear(), 1);
  EXPECT_EQ(waiting.push(submap(3), 900, at(3), kLimits), 0) << "the bytes are gone as well";
}

}  // namespace
}  // namespace fleetloc
