#include "shared/transport/workarounds/repetition_copies.hpp"

#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using testing::Each;
using testing::ElementsAre;

RepeatedDatagram saying(const std::string& text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  return {.subject = bytes, .statement = bytes, .worth_repeating_after = milliseconds(500)};
}

class RepetitionCopiesTest : public testing::Test {
 protected:
  using Locator = RepetitionCopies::Locator;
  static constexpr int kMost = 16;

  int copies(const std::string& text, const Locator& to = kHere) {
    return repetition_.copies(saying(text), to, 100, now_);
  }
  /// Of a datagram that the library sends so often, after each pause.
  std::vector<int> copies_of(const std::string& text, int times, milliseconds pause = seconds(1)) {
    std::vector<int> result;
    for (int i = 0; i < times; ++i, now_ += pause) result.push_back(copies(text));
    return result;
  }
  /// Of one exchange after the other, over a link that loses this share of the datagrams.
  /// @return datagrams each of which was sent in so many copies until one arrived, on average
  double repetitions_at(double loss) {
    std::mt19937 random(1);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same in each run
    std::bernoulli_distribution is_lost(loss);
    const auto all_lost = [&](int count) {
      bool all = true;
      for (int i = 0; i < count; ++i) all &= is_lost(random);
      return all;
    };
    constexpr int kStatements = 2000;
    int repetitions = 0;
    for (int i = 0; i < kStatements; ++i, now_ += seconds(20)) {  // within the budget
      for (; all_lost(copies(std::to_string(i))); now_ += seconds(1)) ++repetitions;
    }
    return static_cast<double>(repetitions) / kStatements;
  }

  static constexpr Locator kHere{.address = 1, .port = 7410};
  static constexpr Locator kElsewhere{.address = 2, .port = 7410};
  RepetitionCopies repetition_{kMost};
  RepetitionCopies::Time now_{seconds(1000)};
};

TEST_F(RepetitionCopiesTest, SendsWhatIsNewOnce) {
  for (int i = 0; i < 10; ++i) EXPECT_EQ(copies(std::to_string(i)), 1);
}

TEST_F(RepetitionCopiesTest, SendsMoreCopiesOfWhatIsRepeatedAgainAndAgain) {
  EXPECT_THAT(copies_of("a", 10), ElementsAre(1, 1, 1, 2, 2, 3, 5, 8, 11, 16));
}

TEST_F(RepetitionCopiesTest, SendsWhatIsNewInAsManyCopiesAsTheLinkWasSeenToNeed) {
  copies_of("a", 7);
  EXPECT_THAT(copies("b"), 3);
  EXPECT_THAT(copies("c", kElsewhere), 1);
}

TEST_F(RepetitionCopiesTest, SendsFewerAgainOnALinkThatNoLongerLoses) {
  copies_of("a", 8);
  for (int i = 0; i < 12; ++i) copies(std::to_string(i));
  EXPECT_EQ(copies("b"), 1);
}

// A copy more than what arrives would need is a datagram for nothing, one fewer costs a second.
TEST_F(RepetitionCopiesTest, LetsTheLibraryRepeatEverythingAboutOnceWhateverTheLoss) {
  EXPECT_LT(repetitions_at(0.0), 0.001);
  for (const double loss : {0.5, 0.7, 0.9}) EXPECT_NEAR(repetitions_at(loss), 1.1, 0.5) << loss;
}

// Over a narrow and slow line an answer takes seconds, and copies would fill it.
TEST_F(RepetitionCopiesTest, TakesWhatIsAnsweredWithinTwoSecondsAsLateNotAsLost) {
  for (int i = 0; i < 20; ++i) EXPECT_THAT(copies_of(std::to_string(i), 3), Each(1));
}

TEST_F(RepetitionCopiesTest, TakesWhatIsSaidTwiceAtOnceForSomebodyElses) {
  EXPECT_THAT(copies_of("heartbeat", 20, milliseconds(10)), Each(1));
}

TEST_F(RepetitionCopiesTest, SpendsNoMoreThanItsBudgetOnADestination) {
  const auto spent_in = [&](int seconds_in) {
    int copies_sent = 0;
    for (int i = 0; i < 4 * seconds_in; ++i, now_ += milliseconds(250)) {
      copies_sent += copies(std::to_string(i / 16)) - 1;  // each said for four seconds
    }
    return 100.0 * copies_sent;
  };
  const double at_first = spent_in(60);
  EXPECT_GT(at_first, 150e3);
  EXPECT_LE(at_first, 200e3 + 60 * 500);
  EXPECT_NEAR(spent_in(60), 60 * 500, 6e3);
  EXPECT_GT(copies("other", kElsewhere) + copies("again", kElsewhere), 1);
}

TEST_F(RepetitionCopiesTest, SendsEverythingOnceWhereTheProfileDoesNotAskForMore) {
  RepetitionCopies once(1);
  for (int i = 0; i < 10; ++i)
    EXPECT_EQ(once.copies(saying("a"), kHere, 100, now_ + i * seconds(1)), 1);
}

TEST_F(RepetitionCopiesTest, TakesWhatComesAgainAfterALongPauseAsNew) {
  EXPECT_THAT(copies_of("announcement", 20, seconds(10)), Each(1));
}

TEST_F(RepetitionCopiesTest, EndsForWhoIsNotThere) {
  const std::vector<int> during = copies_of("heartbeat", 80);
  EXPECT_LE(std::accumulate(during.begin(), during.end(), 0), 80 + 210);
  EXPECT_THAT(copies_of("heartbeat", 20), Each(1));
}

TEST_F(RepetitionCopiesTest, SpendsLittleOnWhoIsNotThereWhereFewCopiesAreAllowed) {
  RepetitionCopies few(4);
  int during = 0;
  for (int i = 0; i < 80; ++i, now_ += seconds(1)) {
    during += few.copies(saying("heartbeat"), kHere, 100, now_);
  }
  EXPECT_LE(during, 80 + 60);
}

TEST_F(RepetitionCopiesTest, WaitsLongerWhereSamplesAreRepeated) {
  RepeatedDatagram sample = saying("sample");
  sample.is_discovery = false;
  for (int i = 0; i <= 5; ++i, now_ += seconds(1)) {
    EXPECT_EQ(repetition_.copies(sample, kHere, 100, now_), 1) << i;
  }
  EXPECT_GT(repetition_.copies(sample, kHere, 100, now_), 1);
}

// Each is encrypted anew: nobody can tell what is said again.
TEST(RepeatedDatagramTest, IsNothingThatIsEncrypted) {
  const Bytes destination = submessage(0x0e, 1, Bytes(12));
  auto submessages = encrypted_submessage();
  EXPECT_FALSE(RepeatedDatagram::read(message_of(submessages)));
  submessages.insert(submessages.begin(), destination);
  EXPECT_FALSE(RepeatedDatagram::read(message_of(submessages)));
  submessages.push_back(heartbeat(1, 2));
  EXPECT_FALSE(RepeatedDatagram::read(message_of(submessages))) << "beside what can be told";
}

}  // namespace
}  // namespace fleetloc
