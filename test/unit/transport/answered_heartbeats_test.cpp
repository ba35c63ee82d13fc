#include "shared/transport/workarounds/answered_heartbeats.hpp"

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

constexpr GuidPrefix kAnsweringServer{0x44, 0x53}, kSecondServer{0x44, 0x54};
constexpr PeerAddressFilter::Locator kAtServer{.address = 1, .port = 11811};
constexpr PeerAddressFilter::Locator kAtOther{.address = 2, .port = 11811};

class AnsweredHeartbeatsTest : public testing::Test {
 protected:
  AnsweredHeartbeatsTest() {
    answered_.watch({{kAnsweringServer, {kAtServer}}, {kSecondServer, {kAtOther}}});
  }

  void acknowledge(std::uint64_t first_missing, const GuidPrefix& from = kAnsweringServer) {
    const auto body = ByteWriter()
                          .entity(kSubscriptionsReader)
                          .entity(kPublicationsWriter)
                          .sequence_number(first_missing)
                          .u32(0)
                          .u32(3)
                          .written();
    answered_.observe(message_of({submessage(0x06, 1, body)}, from));
  }
  bool is_answered(std::uint64_t last,
                   const PeerAddressFilter::Locator& to = kAtServer,
                   std::uint32_t writer = kPublicationsWriter) {
    return answered_.includes(message_of({heartbeat(1, last, 9, writer)}), to);
  }

  AnsweredHeartbeats answered_;
};

TEST_F(AnsweredHeartbeatsTest, AreThoseOfAcknowledgedSamples) {
  EXPECT_FALSE(is_answered(4));
  acknowledge(5);
  EXPECT_TRUE(is_answered(4));
  EXPECT_FALSE(is_answered(5));
}

TEST_F(AnsweredHeartbeatsTest, AreOfOneServerAndOneWriter) {
  acknowledge(5);
  EXPECT_FALSE(is_answered(4, kAtOther));
  EXPECT_FALSE(is_answered(4, {.address = 3, .port = 7410}));
  EXPECT_FALSE(is_answered(4, kAtServer, kParticipantWriter));
  EXPECT_FALSE(answered_.includes(message_of({heartbeat(1, 4), gap(1, 3)}), kAtServer));
}

TEST_F(AnsweredHeartbeatsTest, AreAskedForAgainByAServerThatHasForgottenThem) {
  acknowledge(5);
  acknowledge(0);
  EXPECT_FALSE(is_answered(4));
  acknowledge(5);
  answered_.watch({});
  EXPECT_FALSE(is_answered(4));
}

}  // namespace
}  // namespace fleetloc
