#include "shared/transport/emulated_link.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr EmulatedLink::Time kNow{seconds(1000)};
constexpr std::uint32_t kBytes = 972;  // 1000 with the headers of IPv4 and UDP

TEST(EmulatedLink, OfARobotSendsOnTheUplinkAndReceivesOnTheDownlink) {
  EmulatedLink link(ChannelRole::kRobot, {.uplink = {.delay_s = 0.25}, .downlink = {.loss = 1.0}});
  EXPECT_EQ(link.outgoing_at(kBytes, kNow), kNow + milliseconds(250));
  EXPECT_FALSE(link.incoming_at(kBytes, kNow));
}

TEST(EmulatedLink, OfALocalizerSendsOnTheDownlinkAndReceivesOnTheUplink) {
  EmulatedLink link(ChannelRole::kCloud, {.uplink = {.delay_s = 0.25}, .downlink = {.loss = 1.0}});
  EXPECT_EQ(link.incoming_at(kBytes, kNow), kNow + milliseconds(250));
  EXPECT_FALSE(link.outgoing_at(kBytes, kNow));
}

TEST(EmulatedLink, QueuesDatagramsWithTheirHeaders) {
  const LinkDirection slow{.rate_bytes_per_s = 1000.0, .queue_bytes = 3000};
  EmulatedLink link(ChannelRole::kRobot, {.uplink = slow});
  EXPECT_EQ(link.outgoing_at(kBytes, kNow), kNow + seconds(1));
  EXPECT_EQ(link.outgoing_at(kBytes, kNow), kNow + seconds(2));
  EXPECT_EQ(link.outgoing_at(kBytes, kNow), kNow + seconds(3));
  EXPECT_FALSE(link.outgoing_at(kBytes, kNow)) << "the queue is full";
  EXPECT_EQ(link.incoming_at(kBytes, kNow), kNow) << "the other direction is free";
}

TEST(EmulatedLink, LosesOtherDatagramsInEachDirection) {
  constexpr LinkDirection kLossy{.loss = 0.5};
  EmulatedLink link(ChannelRole::kRobot, {.uplink = kLossy, .downlink = kLossy, .seed = 1});
  int differ = 0;
  for (int i = 0; i < 100; ++i) {
    if (link.outgoing_at(kBytes, kNow).has_value() != link.incoming_at(kBytes, kNow).has_value()) {
      ++differ;
    }
  }
  EXPECT_NEAR(differ, 50, 20);
}

}  // namespace
}  // namespace fleetloc
