#include "shared/transport/workarounds/announcement_repetition.hpp"

#include <optional>

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

constexpr GuidPrefix kOwn{1, 15, 7};
constexpr GuidPrefix kOther{1, 15, 8};

class AnnouncementRepetitionTest : public testing::Test {
 protected:
  std::optional<AnnouncementRepetition::Pause> hear(const Bytes& datagram) {
    return repetition_.heard(datagram, kOwn, now_);
  }
  /// Until nothing more is due.
  AnnouncementRepetition::Pause all_pauses(const GuidPrefix& participant) {
    AnnouncementRepetition::Pause sum{};
    tries_ = 0;
    for (; const auto due = repetition_.again(participant); ++tries_) sum += due->next;
    return sum;
  }

  AnnouncementRepetition repetition_{8};
  AnnouncementRepetition::Time now_{seconds(1000)};
  int tries_ = 0;
};

TEST_F(AnnouncementRepetitionTest, RepeatsForWhoIsNewEverMoreSeldomAndNotForEver) {
  ASSERT_EQ(hear(announced_by(kOther)), milliseconds(500));
  EXPECT_EQ(repetition_.again(kOther)->next, seconds(1));
  EXPECT_EQ(repetition_.again(kOther)->next, seconds(2));
  EXPECT_LT(all_pauses(kOther), minutes(1));
  EXPECT_LT(tries_, 10);
  EXPECT_FALSE(repetition_.again(kOther));
}

TEST_F(AnnouncementRepetitionTest, SendsMoreCopiesEachTime) {
  ASSERT_TRUE(hear(announced_by(kOther)));
  for (const int copies : {2, 4, 8, 8, 8}) EXPECT_EQ(repetition_.again(kOther)->copies, copies);
}

TEST_F(AnnouncementRepetitionTest, RepeatsForWhoeverMayBeThereUntilItIsKnownOrMinutesHavePassed) {
  EXPECT_EQ(repetition_.again_to_all(), seconds(1));
  ASSERT_TRUE(hear(announced_by(kOther)));
  EXPECT_EQ(repetition_.again_to_all(), seconds(8));
  AnnouncementRepetition::Pause sum{};
  while (const auto pause = repetition_.again_to_all()) sum += *pause;
  EXPECT_LT(sum, minutes(6));
  EXPECT_GT(sum, minutes(1));
  AnnouncementRepetition known(8);
  EXPECT_TRUE(known.again_to_all());
  known.heard(message_of({info_destination(kOwn), ack_nack(1)}, kOther), kOwn, now_);
  EXPECT_FALSE(known.again_to_all());
}

TEST_F(AnnouncementRepetitionTest, IsToldOfEachOnce) {
  ASSERT_TRUE(hear(announced_by(kOther)));
  EXPECT_FALSE(hear(announced_by(kOther)));
  EXPECT_TRUE(hear(announced_by({1, 15, 9})));
}

TEST_F(AnnouncementRepetitionTest, EndsWhenItIsKnownThere) {
  ASSERT_TRUE(hear(announced_by(kOther)));
  EXPECT_FALSE(repetition_.is_known());
  EXPECT_FALSE(hear(message_of({info_destination(kOwn), ack_nack(1)}, kOther)));
  EXPECT_TRUE(repetition_.is_known());
  EXPECT_FALSE(repetition_.again(kOther));
}

TEST_F(AnnouncementRepetitionTest, GoesOnWhileOthersAreAddressed) {
  ASSERT_TRUE(hear(announced_by(kOther)));
  EXPECT_FALSE(hear(message_of({info_destination({1, 15, 9}), ack_nack(1)}, kOther)));
  EXPECT_TRUE(repetition_.again(kOther));
}

TEST_F(AnnouncementRepetitionTest, LeavesAloneWhoKnowsItAlready) {
  EXPECT_FALSE(hear(message_of({info_destination(kOwn), ack_nack(1)}, kOther)));
  EXPECT_FALSE(hear(announced_by(kOther)));
  EXPECT_FALSE(repetition_.again(kOther));
}

TEST_F(AnnouncementRepetitionTest, IsOfAnnouncementsAlone) {
  EXPECT_FALSE(hear(message_of({heartbeat(1, 4)}, kOther)));
  EXPECT_TRUE(hear(announced_by(kOther)));
}

TEST_F(AnnouncementRepetitionTest, RemembersNoMoreThanManyAndThoseThatItKnowsAreStillHeard) {
  ASSERT_TRUE(hear(announced_by(kOther)));
  int new_ones = 1;
  for (int i = 0; i < 20'000; ++i) {
    const GuidPrefix somebody{
        1, 15, 9, static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(i)};
    new_ones += hear(announced_by(somebody)) ? 1 : 0;
  }
  EXPECT_EQ(new_ones, 8192);
  EXPECT_TRUE(repetition_.again(kOther));
  now_ += minutes(11);
  EXPECT_TRUE(hear(announced_by({1, 15, 10}))) << "the others are forgotten";
}

}  // namespace
}  // namespace fleetloc
