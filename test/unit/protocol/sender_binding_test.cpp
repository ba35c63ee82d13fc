#include "shared/protocol/sender_binding.hpp"

#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

constexpr double kSilence_s = 35.0;

/// @param end  of the network: a program may have several, one after the other
MessageSender sender(std::uint8_t program, std::uint32_t address, std::uint8_t end = 0) {
  MessageSender sender;
  sender.participant = {1, 15, program, 0, 0, 0, 0, 0, 0, 0, end};
  sender.address = address;
  return sender;
}

class SenderBindingTest : public testing::Test {
 protected:
  bool accepts(const std::string& id, const MessageSender& sender, double s = 0.0) {
    return binding_.accepts(id, sender, at(s));
  }

  SenderBinding binding_{kSilence_s};
  MessageSender robot_ = sender(1, 0x0a000001);
  MessageSender intruder_ = sender(2, 0x0a000009);
};

TEST_F(SenderBindingTest, OnlyTheProgramThatWasFirstSpeaksForAnId) {
  EXPECT_TRUE(accepts("robot_1", robot_));
  EXPECT_FALSE(accepts("robot_1", intruder_, 1.0));
  EXPECT_TRUE(accepts("robot_1", robot_, 2.0));
  EXPECT_TRUE(accepts("robot_2", intruder_, 3.0)) << "for another id it may";
}

TEST_F(SenderBindingTest, WhatIsRefusedKeepsNobodyBound) {
  ASSERT_TRUE(accepts("robot_1", robot_));
  for (double s = 1.0; s < kSilence_s; s += 1.0) EXPECT_FALSE(accepts("robot_1", intruder_, s));
  EXPECT_TRUE(accepts("robot_1", intruder_, kSilence_s + 1.0)) << "the first one is silent";
  EXPECT_FALSE(accepts("robot_1", robot_, kSilence_s + 2.0));
}

TEST_F(SenderBindingTest, AProgramThatMakesItsEndAgainGoesOn) {
  ASSERT_TRUE(accepts("robot_1", robot_));
  EXPECT_TRUE(accepts("robot_1", sender(1, 0x0a000005, 1), 1.0)) << "with another address";
  EXPECT_TRUE(accepts("robot_2", robot_, 2.0)) << "nobody is bound by what it was";
}

TEST_F(SenderBindingTest, AProgramThatIsRestartedOnItsComputerGoesOn) {
  ASSERT_TRUE(accepts("robot_1", robot_));
  EXPECT_TRUE(accepts("robot_1", sender(3, robot_.address), 0.1));
  EXPECT_FALSE(accepts("robot_1", intruder_, 0.2));
}

TEST_F(SenderBindingTest, ComputersThatAreNotKnownAreNotTheSame) {
  ASSERT_TRUE(accepts("robot_1", sender(1, 0)));
  EXPECT_FALSE(accepts("robot_1", sender(2, 0), 0.1));
}

TEST_F(SenderBindingTest, OneEndOfTheNetworkSpeaksForOneId) {
  ASSERT_TRUE(accepts("robot_1", intruder_));
  for (int i = 2; i < 1000; ++i) EXPECT_FALSE(accepts("robot_" + std::to_string(i), intruder_));
  EXPECT_EQ(binding_.ids(), 1U);
}

TEST_F(SenderBindingTest, WhereSendersAreNotKnownAllAreAccepted) {
  EXPECT_TRUE(accepts("robot_1", {}));
  EXPECT_TRUE(accepts("robot_2", {}));
  EXPECT_EQ(binding_.ids(), 0U);
}

TEST_F(SenderBindingTest, WhatIsNoReasonToBindIsAcceptedOfAnybodyUntilSomebodyIsBound) {
  EXPECT_TRUE(binding_.accepts_if_bound("cloud_1", intruder_, at(0.0)));
  EXPECT_EQ(binding_.ids(), 0U);
  ASSERT_TRUE(accepts("cloud_1", robot_));
  EXPECT_FALSE(binding_.accepts_if_bound("cloud_1", intruder_, at(1.0)));
  EXPECT_TRUE(binding_.accepts_if_bound("cloud_1", robot_, at(30.0)));
  EXPECT_FALSE(accepts("cloud_1", intruder_, 40.0)) << "it was heard at 30 s";
}

TEST_F(SenderBindingTest, ManyIdsMakeRoomWhenTheyAreSilentAndPushNobodyOut) {
  ASSERT_TRUE(accepts("robot_1", robot_));
  const auto numbered = [](std::uint32_t i) {
    MessageSender one = sender(9, 0x0b000000 + i);
    one.participant[3] = static_cast<std::uint8_t>(i >> 8U);
    one.participant[4] = static_cast<std::uint8_t>(i);
    return one;
  };
  for (std::uint32_t i = 1; i < SenderBinding::kMaxIds; ++i) {
    ASSERT_TRUE(accepts("id_" + std::to_string(i), numbered(i), 1.0));
  }
  EXPECT_FALSE(accepts("one_more", intruder_, 2.0));
  EXPECT_TRUE(accepts("robot_1", robot_, 30.0));
  EXPECT_TRUE(accepts("one_more", intruder_, 40.0));
  EXPECT_EQ(binding_.ids(), 2U) << "robot_1 and one_more";
  EXPECT_FALSE(accepts("robot_1", numbered(1), 41.0));
}

}  // namespace
}  // namespace fleetloc
