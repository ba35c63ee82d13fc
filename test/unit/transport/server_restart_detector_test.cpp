#include "shared/transport/workarounds/server_restart_detector.hpp"

#include <thread>

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr GuidPrefix kWatchedServer{0x44, 0x53};
constexpr GuidPrefix kStranger{0x01, 0x0f};

class ServerRestartDetectorTest : public testing::Test {
 protected:
  ServerRestartDetectorTest() { watch_.watch({kWatchedServer}); }

  /// A datagram with a heartbeat behind something else.
  bool after(std::chrono::milliseconds pause,
             std::uint32_t count,
             std::uint32_t writer = kParticipantWriter,
             const GuidPrefix& from = kWatchedServer) {
    now_ += pause;
    // Who counts from one again has also forgotten its samples.
    const Bytes one = heartbeat(1, 4 + count, count, writer);
    watch_.observe(message_of({gap(1, 3), one}, from), now_);
    return watch_.has_restarted();
  }

  /// What is to be taken of a heartbeat for the last sample that a server has.
  std::uint32_t count_of(std::uint32_t count, std::uint64_t last_sample) {
    now_ += seconds(3);
    const Bytes datagram =
        message_of({gap(1, 3), heartbeat(1, last_sample, count)}, kWatchedServer);
    const auto changed = watch_.observe(datagram, now_);
    const Bytes& taken = changed ? *changed : datagram;
    EXPECT_EQ(taken.size(), datagram.size());
    return RtpsFields(RtpsBytes(taken).last(4), true).u32();
  }

  ServerRestartDetector watch_;
  ServerRestartDetector::Time now_{seconds(1000)};
};

TEST_F(ServerRestartDetectorTest, SeesHeartbeatsThatCountFromOneAgain) {
  EXPECT_FALSE(after(seconds(0), 1));
  EXPECT_FALSE(after(seconds(3), 7));
  EXPECT_TRUE(after(seconds(2), 1));
  EXPECT_TRUE(after(seconds(3), 2)) << "known until a new participant is made";
  watch_.watch({kWatchedServer});
  EXPECT_FALSE(after(seconds(3), 1)) << "the first that it hears";
}

TEST_F(ServerRestartDetectorTest, TakesChangedOrderForWhatItIs) {
  EXPECT_FALSE(after(seconds(0), 7));
  EXPECT_FALSE(after(milliseconds(300), 6));
  EXPECT_FALSE(after(milliseconds(300), 7)) << "doubled by the network";
}

TEST_F(ServerRestartDetectorTest, CountsEachWriterForItself) {
  EXPECT_FALSE(after(seconds(0), 7));
  EXPECT_FALSE(after(seconds(3), 1, kPublicationsWriter));
  EXPECT_FALSE(after(seconds(3), 8));
  EXPECT_FALSE(after(seconds(3), 2, kPublicationsWriter));
  EXPECT_TRUE(after(seconds(3), 1, kPublicationsWriter));
}

TEST_F(ServerRestartDetectorTest, GoesOnCountingWhereAServerGoesOnFromItsBackup) {
  EXPECT_EQ(count_of(7, 20), 7);
  EXPECT_EQ(count_of(1, 20), 8);
  EXPECT_EQ(count_of(2, 21), 9);
  EXPECT_EQ(count_of(1, 22), 10) << "started a third time";
  EXPECT_EQ(count_of(4, 23), 13);
  EXPECT_FALSE(watch_.has_restarted());
  EXPECT_EQ(count_of(1, 5), 10) << "has lost its backup; a new participant hears it";
  EXPECT_TRUE(watch_.has_restarted());
}

TEST_F(ServerRestartDetectorTest, WatchesNobodyElse) {
  EXPECT_FALSE(after(seconds(0), 7, kParticipantWriter, kStranger));
  EXPECT_FALSE(after(seconds(3), 1, kParticipantWriter, kStranger));
}

TEST_F(ServerRestartDetectorTest, MayBeAskedAndSetWhileOthersObserve) {  // for ThreadSanitizer
  const Bytes message = message_of({heartbeat(1, 4, 7)}, kWatchedServer);
  const auto observe = [&] {
    for (int i = 0; i < 1000; ++i) watch_.observe(message, now_);
  };
  const std::jthread first(observe);
  const std::jthread second(observe);
  for (int i = 0; i < 100; ++i) {
    watch_.watch({kWatchedServer, kStranger});
    EXPECT_FALSE(watch_.has_restarted());
  }
}

}  // namespace
}  // namespace fleetloc
