#include "shared/transport/workarounds/discovery_queue.hpp"

#include <string>

#include <gmock/gmock.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint32_t kUserWriter = 0x000402;

Bytes data_of(std::uint32_t writer, std::uint64_t number) {
  const auto body =
      ByteWriter().u16(0).u16(16).entity(0).entity(writer).sequence_number(number).zeros(8);
  return message_of({submessage(0x15, 1 | 4, body.written())});
}

TEST(RepeatedDatagram, IsOfBuiltInOrReliableEndpoints) {
  EXPECT_TRUE(RepeatedDatagram::read(data_of(kPublicationsWriter, 1)));
  EXPECT_TRUE(RepeatedDatagram::read(data_of(kParticipantWriter, 1)));
  EXPECT_FALSE(RepeatedDatagram::read(data_of(kUserWriter, 1)));
  const auto reliable = RepeatedDatagram::read(message_of({heartbeat(1, 4, 9, kUserWriter)}));
  ASSERT_TRUE(reliable);
  EXPECT_FALSE(reliable->is_discovery);
  EXPECT_TRUE(RepeatedDatagram::read(message_of({heartbeat(1, 4)}))->is_discovery);
  EXPECT_FALSE(RepeatedDatagram::read(Bytes(kRtpsHeaderBytes)));
  EXPECT_FALSE(RepeatedDatagram::read({}));
}

TEST(RepeatedDatagram, IsAboutTheSameIfItSupersedes) {
  const auto subject = [](const Bytes& datagram) {
    return RepeatedDatagram::read(datagram)->subject;
  };
  EXPECT_EQ(subject(message_of({heartbeat(1, 4)})), subject(message_of({heartbeat(1, 5)})));
  EXPECT_EQ(subject(data_of(kPublicationsWriter, 1)), subject(data_of(kPublicationsWriter, 1)));
  EXPECT_NE(subject(data_of(kPublicationsWriter, 1)), subject(data_of(kPublicationsWriter, 2)));
  EXPECT_NE(subject(message_of({heartbeat(1, 4)})), subject(message_of({ack_nack(1)})));
}

TEST(RepeatedDatagram, SaysSomethingElseIfThatIsNew) {
  const auto statement = [](const Bytes& datagram) {
    return RepeatedDatagram::read(datagram)->statement;
  };
  EXPECT_EQ(statement(message_of({heartbeat(1, 4)})), statement(message_of({heartbeat(1, 4)})));
  EXPECT_NE(statement(message_of({heartbeat(1, 4)})), statement(message_of({heartbeat(1, 5)})));
  EXPECT_NE(statement(message_of({ack_nack(1)})), statement(message_of({ack_nack(40)})));
}

/// A queue of 1000 bytes a second, and what leaves it when.
class DiscoveryQueueTest : public testing::Test {
 protected:
  void put(const std::string& subject, const std::string& text, std::size_t bytes = 100) {
    const auto due = queue_.put(
        about(subject), bytes, [this, text] { sent_.push_back(text); }, now_);
    if (due) due_ = due;
  }

  static RepeatedDatagram about(const std::string& text) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    return {.subject = bytes, .statement = bytes, .worth_repeating_after = milliseconds(500)};
  }

  void run_for(milliseconds span) {
    for (const auto end = now_ + span; due_ && *due_ < end;) {
      now_ = std::max(now_, *due_);
      const auto [send, next] = queue_.take(now_);
      if (send) send();
      due_ = next;
    }
  }

  DiscoveryQueue queue_{1000.0};
  DiscoveryQueue::Time now_{std::chrono::hours(1)};
  std::optional<DiscoveryQueue::Time> due_;
  std::vector<std::string> sent_;
};

TEST_F(DiscoveryQueueTest, SendsSomeAtOnceAndTheRestAtItsRate) {
  for (int i = 0; i < 20; ++i) put(std::to_string(i), std::to_string(i));
  run_for(milliseconds(1));
  EXPECT_EQ(sent_.size(), 6U) << "saved up in half a second, and one";
  run_for(milliseconds(1000));
  EXPECT_EQ(sent_.size(), 15U);
  run_for(milliseconds(1000));
  EXPECT_EQ(sent_.size(), 20U);
}

TEST_F(DiscoveryQueueTest, KeepsTheNewestOfThoseAboutTheSameInTheFirstOnesPlace) {
  put("large", "large", 1000);
  put("a", "a, old");
  put("b", "b");
  put("a", "a, new");
  run_for(milliseconds(5000));
  EXPECT_THAT(sent_, ElementsAre("large", "a, new", "b"));
}

TEST_F(DiscoveryQueueTest, LetsThroughWhatNeedNotWait) {
  EXPECT_TRUE(queue_.passes(about("x"), 100, now_));
  EXPECT_TRUE(queue_.passes(about("y"), 500, now_));
  EXPECT_FALSE(queue_.passes(about("z"), 100, now_));
  EXPECT_TRUE(queue_.passes(about("z"), 100, now_ + milliseconds(100)));
  put("a", "a");
  EXPECT_FALSE(queue_.passes(about("z"), 100, now_ + milliseconds(10'000)))
      << "before those that wait";
  EXPECT_THAT(sent_, IsEmpty());
}

TEST_F(DiscoveryQueueTest, KnowsWhatItHasJustSaid) {
  EXPECT_FALSE(queue_.has_just_said(about("x"), now_));
  queue_.passes(about("x"), 100, now_);
  EXPECT_TRUE(queue_.has_just_said(about("x"), now_ + milliseconds(499)));
  EXPECT_FALSE(queue_.has_just_said(about("y"), now_ + milliseconds(499)));
  EXPECT_FALSE(queue_.has_just_said(about("x"), now_ + milliseconds(500)));
}

TEST_F(DiscoveryQueueTest, DropsWhatIsFarTooMuch) {
  for (int i = 0; i < 10'000; ++i) put(std::to_string(i), "");
  run_for(std::chrono::hours(1));
  EXPECT_EQ(sent_.size(), 2000U);
}

}  // namespace
}  // namespace fleetloc
