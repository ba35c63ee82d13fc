#include "shared/transport/workarounds/silent_server_pacing.hpp"

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr GuidPrefix kFirst{1}, kSecond{2};
constexpr PeerAddressFilter::Locator kAtFirst{.address = 1, .port = 11811};
constexpr PeerAddressFilter::Locator kAtSecond{.address = 2, .port = 11811};

class SilentServerPacingTest : public testing::Test {
 protected:
  SilentServerPacingTest() { pacing_.watch({{kFirst, {kAtFirst}}, {kSecond, {kAtSecond}}}); }

  /// Of a datagram every 100 ms for so long.
  int passed(const PeerAddressFilter::Locator& to, seconds during, bool is_other_heard = false) {
    int count = 0;
    for (const auto end = now_ + during; now_ < end; now_ += milliseconds(100)) {
      if (is_other_heard) pacing_.heard(kSecond, now_);
      count += pacing_.passes(to, now_) ? 1 : 0;
    }
    return count;
  }

  SilentServerPacing pacing_;
  SilentServerPacing::Time now_{seconds(1000)};
};

TEST_F(SilentServerPacingTest, AsksASilentServerEverMoreSeldom) {
  EXPECT_EQ(passed(kAtFirst, seconds(10)), 5 * 5);  // windows at 0, 1, 2.5, 5, 9.5 s
  passed(kAtFirst, seconds(60));
  EXPECT_LE(passed(kAtFirst, seconds(85)), 11 * 5);
  EXPECT_GE(passed(kAtFirst, seconds(85)), 9 * 5);
}

TEST_F(SilentServerPacingTest, AsksItMoreSeldomStillWhileAnotherIsThere) {
  passed(kAtFirst, seconds(120), true);
  EXPECT_LE(passed(kAtFirst, seconds(600), true), 10 * 5);
  EXPECT_EQ(passed(kAtSecond, seconds(10), true), 100);
}

TEST_F(SilentServerPacingTest, LeavesAloneAServerThatIsHeard) {
  passed(kAtFirst, seconds(60));
  pacing_.heard(kFirst, now_);
  EXPECT_EQ(passed(kAtFirst, seconds(10)), 100);
  EXPECT_EQ(passed(kAtFirst, seconds(1)), 5) << "it is asked at once when it has become silent";
}

TEST_F(SilentServerPacingTest, LeavesAloneAllThatAreNoServers) {
  EXPECT_EQ(passed({.address = 3, .port = 11811}, seconds(10)), 100);
  EXPECT_EQ(passed({.address = 1, .port = 7410}, seconds(10)), 100);
  pacing_.watch({});
  EXPECT_EQ(passed(kAtFirst, seconds(10)), 100);
}

}  // namespace
}  // namespace fleetloc
