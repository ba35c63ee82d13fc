#include "shared/transport/announcer.hpp"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"
#include "test/unit/transport/recording_socket.hpp"

namespace fleetloc {
namespace {

using eprosima::fastrtps::rtps::IPLocator;
using eprosima::fastrtps::rtps::Locator_t;
using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::Each;
using testing::Field;
using testing::Ge;
using testing::SizeIs;

constexpr GuidPrefix kThisOne{1, 15, 7};
constexpr GuidPrefix kNewcomer{1, 15, 8};
constexpr int kCopies = 4;

Locator_t address(std::uint8_t last) {
  Locator_t locator;
  IPLocator::createLocator(LOCATOR_KIND_UDPv4, "10.0.0." + std::to_string(last), 7410, locator);
  return locator;
}

/// What says to this participant that it is known.
Bytes addressed_to_own() {
  return message_of({info_destination(kThisOne), ack_nack(1)}, kNewcomer);
}

class AnnouncerTest : public testing::Test {
 protected:
  using Clock = Announcer::Clock;

  AnnouncerTest() {
    destinations_.push_back(address(1));
    destinations_.push_back(address(2));
    sender_.begins_with(&socket_);
    announcer_.sent(&socket_, announced_by(kThisOne), destinations_);
  }

  static auto to(std::uint8_t last) {
    return Field(&RecordingSocket::Sent::to, locator_of(address(last)));
  }

  WireLink link_{ChannelRole::kCloud, std::nullopt};
  Announcer::Destinations destinations_;
  RecordingSocket socket_;
  AnnouncementRepetition strangers_{kCopies};
  DatagramSender sender_{link_, delay_line_, false};
  RepeatingSender repeating_sender_{link_, delay_line_, sender_, strangers_};
  Announcer announcer_{link_.addresses, delay_line_, sender_, repeating_sender_, strangers_};
  DelayLine delay_line_;  // last, so that it ends before what it uses
};

TEST_F(AnnouncerTest, RepeatsToEverybodyWhileTheStrangersAddressIsNotKnownAndTakesItsTime) {
  const auto heard = Clock::now();
  announcer_.heard(announced_by(kNewcomer), kThisOne, heard);
  const auto sent = socket_.wait_for(4);
  ASSERT_THAT(sent, SizeIs(4));
  EXPECT_THAT(sent[0], to(1));
  EXPECT_THAT(sent[1], to(2));
  EXPECT_GE(sent[0].at - heard, milliseconds(500));
  EXPECT_GE(sent[2].at - heard, milliseconds(1500));
  EXPECT_THAT(sent, Each(Field(&RecordingSocket::Sent::datagram, announced_by(kThisOne))));
}

TEST_F(AnnouncerTest, RepeatsToTheStrangersOwnAddressInCopies) {
  const auto heard = Clock::now();
  link_.addresses.announced(kNewcomer, locator_of(address(2)), heard);
  announcer_.heard(announced_by(kNewcomer), kThisOne, heard);
  const auto sent = socket_.wait_for(2 + 4);
  ASSERT_THAT(sent, SizeIs(Ge(2 + 4)));
  EXPECT_THAT(sent, Each(to(2)));
  EXPECT_GE(sent[2].at - heard, milliseconds(1500));
}

TEST_F(AnnouncerTest, IsSilentOnceTheStrangerKnowsThisParticipant) {
  const auto now = Clock::now();
  announcer_.heard(announced_by(kNewcomer), kThisOne, now);
  announcer_.heard(addressed_to_own(), kThisOne, now);
  EXPECT_THAT(socket_.wait_for(1, milliseconds(700)), SizeIs(0));
}

TEST_F(AnnouncerTest, RepeatsToWhoeverMayBeThereUntilSomebodyKnowsThisParticipant) {
  const auto begin = Clock::now();
  announcer_.announce_to_all_from(begin);
  const auto sent = socket_.wait_for(2);
  ASSERT_THAT(sent, SizeIs(2));
  EXPECT_GE(sent[0].at - begin, seconds(1));
  announcer_.heard(addressed_to_own(), kThisOne, Clock::now());
  EXPECT_THAT(socket_.wait_for(3, milliseconds(1300)), SizeIs(2));
}

}  // namespace
}  // namespace fleetloc
