#include "shared/transport/ros2/receive_buffers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/full_socket.hpp"

namespace fleetloc {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr int kDefault = 212992;  // [bytes], of Linux
constexpr int kLarge = 4194304;

/// Lines of /proc/net/udp. Port 1CF2 is 7410, of domain 0; 1DEC is 7660, of domain 1.
constexpr const char* kSockets =
    "   sl  local_address rem_address   st tx_queue rx_queue tr tm->when retrnsmt   uid  timeout "
    "inode ref pointer drops            \n"
    " 3049: 0100007F:1CF2 00000000:0000 07 00000000:00000000 00:00000000 00000000  0  0 11 2 0 7 \n"
    " 3050: 0100007F:1CF3 00000000:0000 07 00000000:00000000 00:00000000 00000000  0  0 12 2 0 5 \n"
    " 3051: 0100007F:1DEC 00000000:0000 07 00000000:00000000 00:00000000 00000000  0  0 13 2 0 30\n"
    " 3052: 0100007F:1CF4 00000000:0000 07 00000000:00000000 00:00000000 00000000  0  0 14 2 0 0 \n"
    " 3053: 0100007F:1CF5 00000000:0000 07 00000000:00000000 00:00000000 00000000  0  0 99 2 0 8 \n"
    " 3054: nonsense\n";

TEST(ReceiveBuffers, TellWhatTheSocketsOfThisProcessInADomainHaveLost) {
  const SocketBuffers own{{11, kLarge}, {12, kDefault}, {13, kDefault}, {14, 1000}};
  const BufferLoss loss = buffer_loss(kSockets, own, 0);
  EXPECT_EQ(loss.datagrams, 12U);
  EXPECT_EQ(loss.buffer_bytes, kDefault);  // not of a socket that has lost nothing
  EXPECT_EQ(buffer_loss(kSockets, own, 1).datagrams, 30U);
  EXPECT_EQ(buffer_loss(kSockets, own, 2).datagrams, 0U);
  EXPECT_EQ(buffer_loss("", own, 0).datagrams, 0U);
}

TEST(ReceiveBuffers, AreCountedByTheKernel) {
  constexpr std::uint32_t kDomain = 100;
  EXPECT_EQ(buffer_loss(kDomain).datagrams, 0U);
  {
    const FullSocket socket(kDomain);
    const BufferLoss loss = buffer_loss(kDomain);
    EXPECT_GT(loss.datagrams, 50U);
    EXPECT_EQ(loss.buffer_bytes, FullSocket::kBuffer);
  }
  EXPECT_EQ(buffer_loss(kDomain).datagrams, 0U);
}

TEST(ReceiveBuffers, AdviseTheSettingThatLimitsThem) {
  const std::string kernel = buffer_advice({.datagrams = 40, .buffer_bytes = kDefault}, kDefault);
  EXPECT_THAT(kernel,
              AllOf(HasSubstr("40 datagrams of ROS 2 were lost"),
                    HasSubstr("208 KB"),
                    HasSubstr("sysctl -w net.core.rmem_max=4194304"),
                    Not(HasSubstr("receiveBufferSize"))));
  const std::string profile = buffer_advice({.datagrams = 1, .buffer_bytes = kDefault}, kLarge);
  EXPECT_THAT(profile,
              AllOf(HasSubstr("receiveBufferSize in the QoS profiles of ROS 2, to 4194304"),
                    Not(HasSubstr("rmem_max"))));
  const std::string both = buffer_advice({.datagrams = 1, .buffer_bytes = kLarge}, kLarge);
  EXPECT_THAT(both,
              AllOf(HasSubstr("net.core.rmem_max=8388608"),
                    HasSubstr("receiveBufferSize in the QoS profiles of ROS 2, to 8388608")));
}

TEST(ReceiveBuffers, KnowWhatTheKernelAllows) {
  EXPECT_GT(rmem_max_bytes(), 0);
}

}  // namespace
}  // namespace fleetloc
