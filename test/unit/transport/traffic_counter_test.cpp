#include "shared/transport/traffic_counter.hpp"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

constexpr std::uint64_t kHeaders = 28;  // of IPv4 and UDP

TEST(TrafficCounter, CountsTheHeadersOfIpAndUdp) {
  TrafficCounter counter;
  counter.received(100);
  const WireTraffic traffic = counter.total();
  EXPECT_EQ(traffic.received_datagrams, 1);
  EXPECT_EQ(traffic.received_bytes, 100 + kHeaders);
  EXPECT_EQ(traffic.sent_datagrams, 0);
}

TEST(TrafficCounter, CountsADatagramForEachAddressThatItIsSentTo) {
  TrafficCounter counter;
  counter.sent(100, 3);
  counter.sent(50, 0);
  const WireTraffic traffic = counter.total();
  EXPECT_EQ(traffic.sent_datagrams, 3);
  EXPECT_EQ(traffic.sent_bytes, 3 * (100 + kHeaders));
  EXPECT_EQ(traffic.received_datagrams, 0);
}

TEST(TrafficCounter, LosesNothingToOtherThreads) {
  constexpr std::uint64_t kThreads = 4;
  constexpr std::uint64_t kEach = 10'000;
  TrafficCounter counter;
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t i = 0; i < kThreads; ++i) {
      threads.emplace_back([&] {
        for (std::uint64_t n = 0; n < kEach; ++n) {
          counter.sent(10, 2);
          counter.received(20);
        }
      });
    }
  }
  const WireTraffic traffic = counter.total();
  EXPECT_EQ(traffic.sent_datagrams, 2 * kThreads * kEach);
  EXPECT_EQ(traffic.sent_bytes, 2 * kThreads * kEach * (10 + kHeaders));
  EXPECT_EQ(traffic.received_datagrams, kThreads * kEach);
  EXPECT_EQ(traffic.received_bytes, kThreads * kEach * (20 + kHeaders));
}

}  // namespace
}  // namespace fleetloc
