// Submaps that arrive faster than anybody takes them.
#include <cstdint>

#include <gtest/gtest.h>

#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

// 24 MB that nobody takes: the oldest go. With keys the same ones come more slowly: the profile's
// writers send 1.4 MB/s.
TEST(Inbox, IsNotFilledByLongSubmaps) {
  constexpr std::size_t kLargest = 16U << 20U;
  constexpr std::size_t kRows = 16'000;  // of 2 bytes
  const TestNetwork network;
  DdsChannel cloud(on_loopback(network.domain(), ChannelRole::kCloud, "cloud_1"));
  DdsChannel intruder(on_loopback(network.domain(), ChannelRole::kRobot, "mallory"));
  ASSERT_TRUE(matches(intruder, Topic::kSubmap, "cloud_1"));
  std::uint32_t number = 0;
  ASSERT_TRUE(comes_true([&] {
    intruder.send("cloud_1", numbered_submap(++number, "mallory", kRows), {});
    return cloud.diagnostics().overflowed > 10;
  }));
  std::size_t bytes = 0;
  for (const Message& message : cloud.receive({})) bytes += message.payload.size();
  EXPECT_LE(bytes, kLargest);
  EXPECT_GT(bytes, kLargest / 2);
}

}  // namespace
}  // namespace fleetloc
