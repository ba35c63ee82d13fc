#include "shared/transport/workarounds/discovery_repetition.hpp"

#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using testing::Each;
using testing::ElementsAre;

DiscoveryDatagram saying(const std::string& text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  return {.subject = bytes, .statement = bytes, .worth_repeating_after = milliseconds(500)};
}

class DiscoveryRepetitionTest : public testing::Test {
 protected:
  /// Of a datagram that the library sends so often, after each pause.
  std::vector<int> copies(const std::string& text, int times, milliseconds pause = seconds(1)) {
    std::vector<int> result;
    for (int i = 0; i < times; ++i, now_ += pause) {
      result.push_back(repetition_.copies(saying(text), now_));
    }
    return result;
  }

  DiscoveryRepetition repetition_{4};
  DiscoveryRepetition::Time now_{seconds(1000)};
};

TEST_F(DiscoveryRepetitionTest, SendsWhatIsNewOnce) {
  EXPECT_THAT(copies("a", 1), ElementsAre(1));
  EXPECT_THAT(copies("b", 1), ElementsAre(1));
}

TEST_F(DiscoveryRepetitionTest, SendsMoreCopiesOfWhatIsRepeatedAgainAndAgain) {
  EXPECT_THAT(copies("a", 7), ElementsAre(1, 1, 2, 3, 4, 4, 4));
  EXPECT_THAT(copies("b", 1), ElementsAre(1));
}

TEST_F(DiscoveryRepetitionTest, SendsEverythingOnceWhereTheProfileDoesNotAskForMore) {
  DiscoveryRepetition once(1);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(once.copies(saying("a"), now_ + i * seconds(1)), 1);
}

TEST_F(DiscoveryRepetitionTest, TakesWhatComesAgainAfterALongPauseAsNew) {
  EXPECT_THAT(copies("announcement", 20, seconds(10)), Each(1));
}

TEST_F(DiscoveryRepetitionTest, EndsForWhoIsNotThere) {
  const std::vector<int> during = copies("heartbeat", 80);
  EXPECT_LE(std::accumulate(during.begin(), during.end(), 0), 80 + 60);
  EXPECT_THAT(copies("heartbeat", 20), Each(1));
}

}  // namespace
}  // namespace fleetloc
