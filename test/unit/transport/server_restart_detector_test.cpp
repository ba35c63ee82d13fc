#include "shared/transport/workarounds/server_restart_detector.hpp"

#include <thread>

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr GuidPrefix kServer{0x44, 0x53};
constexpr GuidPrefix kOther{0x01, 0x0f};

class ServerRestartDetectorTest : public testing::Test {
 protected:
  ServerRestartDetectorTest() { watch_.watch({kServer}); }

  /// A datagram with a heartbeat behind something else.
  bool after(std::chrono::milliseconds pause,
             std::uint32_t count,
             std::uint32_t writer = kParticipantWriter,
             const GuidPrefix& from = kServer) {
    now_ += pause;
    watch_.observe(message_of({gap(1, 3), heartbeat(1, 4, count, writer)}, from), now_);
    return watch_.has_restarted();
  }

  ServerRestartDetector watch_;
  ServerRestartDetector::Time now_{seconds(1000)};
};

TEST_F(ServerRestartDetectorTest, SeesHeartbeatsThatCountFromOneAgain) {
  EXPECT_FALSE(after(seconds(0), 1));
  EXPECT_FALSE(after(seconds(3), 7));
  EXPECT_TRUE(after(seconds(2), 1));
  EXPECT_TRUE(after(seconds(3), 2)) << "known until a new participant is made";
  watch_.watch({kServer});
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

TEST_F(ServerRestartDetectorTest, WatchesNobodyElse) {
  EXPECT_FALSE(after(seconds(0), 7, kParticipantWriter, kOther));
  EXPECT_FALSE(after(seconds(3), 1, kParticipantWriter, kOther));
}

TEST_F(ServerRestartDetectorTest, MayBeAskedAndSetWhileOthersObserve) {  // for ThreadSanitizer
  const Bytes message = message_of({heartbeat(1, 4, 7)}, kServer);
  const auto observe = [&] {
    for (int i = 0; i < 1000; ++i) watch_.observe(message, now_);
  };
  const std::jthread first(observe);
  const std::jthread second(observe);
  for (int i = 0; i < 100; ++i) {
    watch_.watch({kServer, kOther});
    EXPECT_FALSE(watch_.has_restarted());
  }
}

}  // namespace
}  // namespace fleetloc
