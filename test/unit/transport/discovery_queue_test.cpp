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

TEST(RepeatedDatagram, OfAHandshakeIsTheSameWithAnotherNumber) {
  const auto first = *RepeatedDatagram::read(message_of({handshake(1, {1}, 1)}));
  const auto again = *RepeatedDatagram::read(message_of({handshake(1, {1}, 2)}));
  const auto next = *RepeatedDatagram::read(message_of({handshake(2, {1}, 3)}));
  EXPECT_TRUE(first.is_handshake && first.is_secure && first.is_discovery);
  EXPECT_EQ(first.statement, again.statement);
  EXPECT_EQ(first.subject, next.subject);
  EXPECT_NE(first.statement, next.statement);
}

TEST(RepeatedDatagram, IsAboutAKeyIfItIsEncryptedAndHasNoSample) {
  const auto read = [](std::uint32_t key, std::uint32_t bytes, std::uint8_t to = 7) {
    return *RepeatedDatagram::read_encrypted(encrypted_message(key, bytes, to));
  };
  EXPECT_TRUE(read(5, 32).is_secure && read(5, 32).is_discovery);
  EXPECT_EQ(read(5, 32).statement, read(5, 32).statement);
  EXPECT_NE(read(5, 32).subject, read(6, 32).subject);
  EXPECT_NE(read(5, 32).subject, read(5, 32, 8).subject);
  EXPECT_NE(read(5, 32).subject, read(5, 28).subject) << "with a set and without";
  EXPECT_LT(read(0, 32).worth_repeating_after, read(5, 32).worth_repeating_after);
}

TEST(RepeatedDatagram, IsAboutItselfOnlyIfItIsEncryptedAndHasASample) {
  const Bytes one = encrypted_message(5, 300);
  Bytes other = one;
  other[kRtpsHeaderBytes + 16 + 4 + 8] ^= 1U;  // of the initialization vector
  EXPECT_NE(RepeatedDatagram::read_encrypted(one)->subject,
            RepeatedDatagram::read_encrypted(other)->subject);
  EXPECT_FALSE(RepeatedDatagram::read_encrypted(message_of({heartbeat(1, 4)})));
  EXPECT_FALSE(RepeatedDatagram::read_encrypted(Bytes(kRtpsHeaderBytes)));
  EXPECT_FALSE(RepeatedDatagram::read_encrypted({}));
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

TEST_F(DiscoveryQueueTest, SendsAHandshakeAgainWhenItsAnswerIsOverdue) {
  RepeatedDatagram handshake = about("request");
  handshake.is_handshake = true;
  EXPECT_TRUE(queue_.passes(handshake, 4000, now_));
  EXPECT_TRUE(queue_.has_just_said(handshake, now_ + milliseconds(6999)));
  EXPECT_FALSE(queue_.has_just_said(handshake, now_ + milliseconds(7000)))
      << "3 s after the 4 s that it takes";
}

TEST_F(DiscoveryQueueTest, PutsWhatIsSecureBeforeTheRest) {
  put("large", "large", 1000);
  put("a", "a");
  put("b", "b");
  for (const std::string text : {"secure 1", "secure 2"}) {
    RepeatedDatagram datagram = about(text);
    datagram.is_secure = true;
    queue_.put(
        datagram, 100, [this, text] { sent_.push_back(text); }, now_);
  }
  put("c", "c");
  run_for(milliseconds(5000));
  EXPECT_THAT(sent_, ElementsAre("secure 1", "secure 2", "large", "a", "b", "c"));
}

TEST_F(DiscoveryQueueTest, DropsWhatIsFarTooMuch) {
  for (int i = 0; i < 10'000; ++i) put(std::to_string(i), "");
  run_for(std::chrono::hours(1));
  EXPECT_EQ(sent_.size(), 2000U);
}

}  // namespace
}  // namespace fleetloc
