#include "shared/transport/emulated_link.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr EmulatedLink::Time kNow{seconds(1000)};
constexpr std::uint32_t kBytes = 972;  // 1000 with the headers of IPv4 and UDP

TEST(EmulatedLink, OfARobotSendsOnTheUplinkAndReceivesOnTheDownlink) {
  EmulatedLink link(ChannelRole::kRobot, {.uplink = {.delay_s = 0.25}, .downlink = {.loss = 1.0}});
  EXPECT_THAT(link.outgoing_at(kBytes, kNow), ElementsAre(kNow + milliseconds(250)));
  EXPECT_THAT(link.incoming_at(kBytes, kNow), IsEmpty());
}

TEST(EmulatedLink, OfALocalizerSendsOnTheDownlinkAndReceivesOnTheUplink) {
  EmulatedLink link(ChannelRole::kCloud, {.uplink = {.delay_s = 0.25}, .downlink = {.loss = 1.0}});
  EXPECT_THAT(link.incoming_at(kBytes, kNow), ElementsAre(kNow + milliseconds(250)));
  EXPECT_THAT(link.outgoing_at(kBytes, kNow), IsEmpty());
}

TEST(EmulatedLink, QueuesDatagramsWithTheirHeaders) {
  const LinkDirection slow{.rate_bytes_per_s = 1000.0, .queue_bytes = 3000};
  EmulatedLink link(ChannelRole::kRobot, {.uplink = slow});
  EXPECT_THAT(link.outgoing_at(kBytes, kNow), ElementsAre(kNow + seconds(1)));
  EXPECT_THAT(link.outgoing_at(kBytes, kNow), ElementsAre(kNow + seconds(2)));
  EXPECT_THAT(link.outgoing_at(kBytes, kNow), ElementsAre(kNow + seconds(3)));
  EXPECT_THAT(link.outgoing_at(kBytes, kNow), IsEmpty()) << "the queue is full";
  EXPECT_THAT(link.incoming_at(kBytes, kNow), ElementsAre(kNow)) << "the other direction is free";
}

TEST(EmulatedLink, LosesOtherDatagramsInEachDirection) {
  constexpr LinkDirection kLossy{.loss = 0.5};
  EmulatedLink link(ChannelRole::kRobot, {.uplink = kLossy, .downlink = kLossy, .seed = 1});
  int differ = 0;
  for (int i = 0; i < 100; ++i) {
    if (link.outgoing_at(kBytes, kNow).empty() != link.incoming_at(kBytes, kNow).empty()) ++differ;
  }
  EXPECT_NEAR(differ, 50, 20);
}

TEST(EmulatedLink, HasItsOutagesInBothDirectionsAtTheSameTime) {
  const LinkDirection out{.outages = {.at = {{.from_s = 10.0, .for_s = 1.0}}}};
  EmulatedLink link(ChannelRole::kRobot, {.uplink = out, .downlink = out});
  EXPECT_THAT(link.incoming_at(kBytes, kNow), ElementsAre(kNow));
  EXPECT_THAT(link.outgoing_at(kBytes, kNow + seconds(10)), IsEmpty());
  EXPECT_THAT(link.incoming_at(kBytes, kNow + seconds(10)), IsEmpty());
  EXPECT_THAT(link.outgoing_at(kBytes, kNow + seconds(11)), ElementsAre(kNow + seconds(11)));
}

TEST(EmulatedLink, GivesTheTimesOfBothCopies) {
  EmulatedLink link(ChannelRole::kRobot, {.uplink = {.delay_s = 1.0, .duplication = 1.0}});
  EXPECT_THAT(link.outgoing_at(kBytes, kNow), ElementsAre(kNow + seconds(1), kNow + seconds(1)));
}

}  // namespace
}  // namespace fleetloc
