#include "shared/transport/own_datagrams.hpp"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

constexpr GuidPrefix kSelf{1, 15, 1};
constexpr GuidPrefix kForeign{1, 15, 2};

TEST(OwnDatagrams, AreThoseOfTheParticipantThatSends) {
  OwnDatagrams own;
  own.sent(message_of({heartbeat(1, 2)}, kSelf));
  EXPECT_TRUE(own.includes(message_of({gap(1, 2)}, kSelf)));
  EXPECT_FALSE(own.includes(message_of({heartbeat(1, 2)}, kForeign)));
}

TEST(OwnDatagrams, TellThoseOfTheSameProcess) {
  const GuidPrefix own_prefix{1, 15, 7, 7, 5, 5, 9, 9, 0, 0, 0, 0};
  const GuidPrefix sibling{1, 15, 7, 7, 5, 5, 9, 9, 1, 0, 0, 0};
  const GuidPrefix stranger{1, 15, 7, 7, 5, 6, 9, 9, 1, 0, 0, 0};
  OwnDatagrams own;
  EXPECT_FALSE(own.are_of_same_process(message_of({}, sibling)));
  own.sent(message_of({}, own_prefix));
  EXPECT_TRUE(own.are_of_same_process(message_of({}, sibling)));
  EXPECT_FALSE(own.are_of_same_process(message_of({}, stranger)));
}

TEST(OwnDatagrams, AreNoneBeforeTheFirstIsSent) {
  const OwnDatagrams own;
  EXPECT_FALSE(own.includes(message_of({}, kSelf)));
  EXPECT_FALSE(own.includes(message_of({}, GuidPrefix{})));
}

TEST(OwnDatagrams, AreNotLearnedFromAPartOfAHeader) {
  OwnDatagrams own;
  const Bytes whole = message_of({}, kSelf);
  own.sent(RtpsBytes(whole).first(whole.size() - 1));
  EXPECT_FALSE(own.includes(whole));
  own.sent(whole);
  EXPECT_TRUE(own.includes(whole));
  EXPECT_FALSE(own.includes(RtpsBytes(whole).first(whole.size() - 1)));
}

TEST(OwnDatagrams, AreKnownInFullOrNotAtAllToOtherThreads) {
  for (int round = 0; round < 100; ++round) {
    OwnDatagrams own;
    const Bytes message = message_of({}, kSelf);
    const Bytes others = message_of({}, kForeign);
    std::atomic<bool> wrong = false;
    {
      const auto send = [&] { own.sent(message); };
      const std::jthread first(send);
      const std::jthread second(send);
      const std::jthread receiver([&] {
        while (!own.includes(message)) wrong = wrong || own.includes(others);
      });
    }
    EXPECT_FALSE(wrong);
    EXPECT_TRUE(own.includes(message));
  }
}

}  // namespace
}  // namespace fleetloc
