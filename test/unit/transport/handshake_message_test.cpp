#include "shared/transport/workarounds/handshake_message.hpp"

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

const GuidPrefix kRobot1{1, 15, 1};
const GuidPrefix kRobot2{1, 15, 2};

Bytes to(const GuidPrefix& participant, const Bytes& message) {
  return message_of({submessage(0x0e, 1, {participant.begin(), participant.end()}), message});
}

TEST(HandshakeMessage, GoesToItsReceiverOnly) {
  EXPECT_FALSE(is_handshake_for_another(to(kRobot1, handshake(1, kRobot1))));
  EXPECT_TRUE(is_handshake_for_another(to(kRobot2, handshake(1, kRobot1))));
}

TEST(HandshakeMessage, GoesOutIfItIsNotSaidToWhom) {
  EXPECT_FALSE(is_handshake_for_another(message_of({handshake(1, kRobot1)})));
}

TEST(HandshakeMessage, IsNothingElse) {
  for (const auto& [name, other] : valid_submessages()) {
    if (name == "handshake") continue;
    EXPECT_FALSE(is_handshake_for_another(to(kRobot1, other))) << name;
  }
  EXPECT_FALSE(is_handshake_for_another(encrypted_message(0, 28)));
  EXPECT_FALSE(is_handshake_for_another(Bytes(kRtpsHeaderBytes)));
  EXPECT_FALSE(is_handshake_for_another({}));
}

TEST(HandshakeMessage, IsNoneWhereItIsCutOff) {
  const Bytes whole = handshake(1, kRobot1);
  for (std::size_t size = 4; size < 4 + 20 + 4 + 48 + 12; ++size) {
    const Bytes body(whole.begin() + 4, whole.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(is_handshake_for_another(to(kRobot2, submessage(0x15, 1 | 4, body)))) << size;
  }
}

}  // namespace
}  // namespace fleetloc
