#include <random>
#include <set>

#include <gtest/gtest.h>

#include "shared/protocol/submap_receiver.hpp"
#include "shared/protocol/submap_sender.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

Submap with_keyframe(std::uint32_t id) {
  Submap submap;
  submap.keyframes.resize(1);
  submap.keyframes[0].id = KeyframeId{id};
  return submap;
}

LocalizationResult answer_to(std::uint32_t keyframe,
                             const SubmapReceiver& receiver,
                             std::uint32_t incarnation = 1) {
  LocalizationResult answer;
  answer.session = SessionNumber{1};
  answer.incarnation = Incarnation{incarnation};
  answer.keyframe = KeyframeId{keyframe};
  answer.acknowledgements = receiver.acknowledgements();
  return answer;
}

TEST(SubmapReceiver, KnowsWhatItHasStored) {
  SubmapReceiver receiver;
  EXPECT_TRUE(receiver.is_new(SampleNumber{0}));
  receiver.store(SampleNumber{0}, {});
  receiver.store(SampleNumber{2}, {});
  EXPECT_FALSE(receiver.is_new(SampleNumber{0}));
  EXPECT_TRUE(receiver.is_new(SampleNumber{1}));
  EXPECT_FALSE(receiver.is_new(SampleNumber{2}));
  EXPECT_EQ(receiver.acknowledgements().bitmap, 0b101U);
}

TEST(SubmapReceiver, AgreesWithASetWhateverTheOrder) {
  std::mt19937 random(7);
  SubmapReceiver receiver;
  std::set<std::uint32_t> stored;
  std::uint32_t newest = 0;
  for (int round = 0; round < 2000; ++round) {
    const auto step = static_cast<std::uint32_t>(random() % 8);
    const std::uint32_t number = newest + step > 4 ? newest + step - 4 : 0;
    const auto base = static_cast<std::uint32_t>(receiver.acknowledgements().base);
    EXPECT_EQ(receiver.is_new(SampleNumber{number}), number >= base && !stored.contains(number));
    receiver.store(SampleNumber{number}, {});
    if (number >= base) stored.insert(number);
    newest = std::max(newest, number);
  }
}

TEST(SubmapReceiver, FarJumpsForgetWhatIsOlder) {
  SubmapReceiver receiver;
  receiver.store(SampleNumber{5}, {});
  receiver.store(SampleNumber{4'000'000'000}, {});
  EXPECT_FALSE(receiver.is_new(SampleNumber{5}));
  EXPECT_FALSE(receiver.is_new(SampleNumber{4'000'000'000}));
  EXPECT_TRUE(receiver.is_new(SampleNumber{3'999'999'999}));
}

TEST(SubmapReceiver, ItIsNotDeafenedByAFirstNumberThatIsFarAhead) {
  SubmapReceiver receiver;
  receiver.store(SampleNumber{4'000'000'000}, {});
  EXPECT_FALSE(receiver.is_new(SampleNumber{7})) << "it might be a late one";
  EXPECT_TRUE(receiver.is_new(SampleNumber{8}));
  receiver.store(SampleNumber{8}, {});
  EXPECT_EQ(receiver.acknowledgements().base, SampleNumber{8});
  EXPECT_EQ(receiver.acknowledgements().bitmap, 1U);
  EXPECT_TRUE(receiver.is_new(SampleNumber{9}));
}

TEST(SubmapReceiver, MeasuresTheShareThatIsLost) {
  SubmapReceiver receiver;
  EXPECT_EQ(receiver.loss(), 0.0);
  for (std::uint32_t i = 0; i < 200; i += 4) receiver.store(SampleNumber{i}, {});
  EXPECT_NEAR(receiver.loss(), 0.75, 0.03);
}

TEST(SubmapReceiver, CountsNothingAsLostBeforeItsFirstSample) {
  SubmapReceiver receiver;
  receiver.store(SampleNumber{400}, {});
  EXPECT_EQ(receiver.loss(), 0.0);
  receiver.store(SampleNumber{403}, {});
  EXPECT_EQ(receiver.loss(), 0.5);
}

TEST(SubmapSender, NumbersSamplesFromZeroInEachSession) {
  SubmapSender sender;
  sender.restart(SessionNumber{1}, Incarnation{1});
  Submap submap = with_keyframe(1);
  sender.prepare(submap, at_ms(0));
  sender.prepare(submap, at_ms(1));
  EXPECT_EQ(submap.number, SampleNumber{1});
  sender.restart(SessionNumber{2}, Incarnation{1});
  sender.prepare(submap, at_ms(2));
  EXPECT_EQ(submap.number, SampleNumber{0});
  EXPECT_EQ(submap.session, SessionNumber{2});
}

TEST(SubmapSender, UsesNoNumberAgainThatAnotherSenderHasUsedInThisSession) {
  SubmapSender sender;
  sender.restart(SessionNumber{1}, Incarnation{1});
  Submap submap = with_keyframe(1);
  sender.prepare(submap, at_ms(0));
  sender.restart(SessionNumber{1}, Incarnation{2}, 7);
  sender.prepare(submap, at_ms(1));
  EXPECT_EQ(submap.number, SampleNumber{7});
  sender.restart(SessionNumber{1}, Incarnation{1}, 3);
  sender.prepare(submap, at_ms(2));
  EXPECT_EQ(submap.number, SampleNumber{8});
}

TEST(SubmapSender, MeasuresRoundTripAndLoss) {
  SubmapSender sender;
  SubmapReceiver receiver;
  sender.restart(SessionNumber{1}, Incarnation{1});
  for (std::uint32_t i = 0; i < 40; ++i) {
    Submap submap = with_keyframe(i);
    const int now = static_cast<int>(i) * 100;
    sender.prepare(submap, at_ms(now));
    if (i % 2 == 1) continue;  // lost
    receiver.store(submap.number, {});
    sender.acknowledge(answer_to(i, receiver), at_ms(now + 80));
  }
  ASSERT_TRUE(sender.round_trip().has_value());
  EXPECT_EQ(*sender.round_trip(), milliseconds(80));
  EXPECT_NEAR(sender.loss(), 0.5, 0.03);
}

TEST(SubmapSender, TimesTheNetworkByTheSampleThatArrivedAndNotByOneThatWasLost) {
  SubmapSender sender;
  SubmapReceiver receiver;
  sender.restart(SessionNumber{1}, Incarnation{1});
  Submap submap = with_keyframe(7);
  sender.prepare(submap, at_ms(0));  // lost
  sender.prepare(submap, at_ms(1000));
  receiver.store(submap.number, at_ms(1030));
  LocalizationResult answer = answer_to(7, receiver);
  answer.holding_time = receiver.since_newest(at_ms(1110));
  EXPECT_EQ(sender.acknowledge(answer, at_ms(1140)), milliseconds(60));
  EXPECT_EQ(sender.round_trip(), milliseconds(140));
  // A repeated one tells of the network, too, but not how long the answer took.
  answer.holding_time = receiver.since_newest(at_ms(3110));
  EXPECT_EQ(sender.acknowledge(answer, at_ms(3150)), milliseconds(70));
  EXPECT_EQ(sender.round_trip(), milliseconds(140));
}

TEST(SubmapSender, RightAfterTheStartItReliesOnNoSample) {
  SubmapSender sender;
  SubmapReceiver receiver;
  sender.restart(SessionNumber{1}, Incarnation{1});
  Submap submap = with_keyframe(7);
  sender.prepare(submap, at_ms(0));
  EXPECT_GE(sender.expected_loss(at_ms(10)), 0.5);
  receiver.store(submap.number, at_ms(10));
  sender.acknowledge(answer_to(7, receiver), at_ms(20));
  EXPECT_LT(sender.expected_loss(at_ms(20)), 0.25);
}

TEST(SubmapSender, ANewIncarnationVoidsTheAcknowledgements) {
  SubmapSender sender;
  SubmapReceiver receiver;
  sender.restart(SessionNumber{1}, Incarnation{1});
  for (std::uint32_t i = 0; i < 10; ++i) {
    Submap submap = with_keyframe(i);
    sender.prepare(submap, at_ms(0));
    if (i == 0 || i == 9) receiver.store(submap.number, {});
  }
  sender.acknowledge(answer_to(9, receiver), at_ms(1));
  EXPECT_GT(sender.loss(), 0.5);
  sender.restart(SessionNumber{1}, Incarnation{2});
  EXPECT_EQ(sender.loss(), 0.0);
  sender.acknowledge(answer_to(9, receiver, 1), at_ms(3));  // late, from before the restart
  EXPECT_EQ(sender.loss(), 0.0);
  Submap submap = with_keyframe(10);
  sender.prepare(submap, at_ms(4));
  EXPECT_EQ(submap.incarnation, Incarnation{2});
  EXPECT_EQ(submap.number, SampleNumber{10});  // the session's
}

TEST(SubmapSender, ItIsNotDeafenedByAnAcknowledgementOfWhatWasNeverSent) {
  SubmapSender sender;
  SubmapReceiver receiver;
  sender.restart(SessionNumber{1}, Incarnation{1});
  LocalizationResult wrong;
  wrong.session = SessionNumber{1};
  wrong.incarnation = Incarnation{1};
  wrong.acknowledgements = {SampleNumber{4'000'000'000}, 1};
  EXPECT_FALSE(sender.is_of_stream(wrong));
  sender.acknowledge(wrong, at_ms(0));
  for (std::uint32_t i = 0; i < 10; ++i) {
    Submap submap = with_keyframe(i);
    sender.prepare(submap, at_ms(0));
    if (i == 0 || i == 9) receiver.store(submap.number, at_ms(0));
  }
  sender.acknowledge(answer_to(9, receiver), at_ms(1));
  EXPECT_GT(sender.loss(), 0.5);
}

TEST(SubmapSender, KnowsWhatAwaitsAnAnswer) {
  SubmapSender sender;
  SubmapReceiver receiver;
  sender.restart(SessionNumber{1}, Incarnation{1});
  for (std::uint32_t i = 0; i < 3; ++i) {
    Submap submap = with_keyframe(i);
    sender.prepare(submap, at_ms(0));
  }
  receiver.store(SampleNumber{1}, at_ms(1));
  sender.acknowledge(answer_to(1, receiver), at_ms(1));
  EXPECT_FALSE(sender.awaits(KeyframeId{0}));
  EXPECT_FALSE(sender.awaits(KeyframeId{1}));
  EXPECT_TRUE(sender.awaits(KeyframeId{2}));
  EXPECT_FALSE(sender.awaits(KeyframeId{3}));
}

}  // namespace
}  // namespace fleetloc
