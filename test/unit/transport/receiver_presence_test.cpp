#include "shared/transport/receiver_presence.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

class ReceiverPresenceTest : public testing::Test {
 protected:
  using Names = std::set<std::string>;

  std::vector<std::string> absent(int s, const Names& receivers, const Names& present) {
    return presence_.absent(receivers, present, ReceiverPresence::Time(seconds(s)));
  }

  ReceiverPresence presence_{seconds(60)};
};

TEST_F(ReceiverPresenceTest, EndsAMinuteAfterAReceiverWasSeenLast) {
  EXPECT_THAT(absent(0, {"a", "b"}, {"a"}), IsEmpty());
  EXPECT_THAT(absent(60, {"a", "b"}, {"a"}), IsEmpty());
  EXPECT_THAT(absent(61, {"a", "b"}, {"a"}), ElementsAre("b")) << "it never came";
  EXPECT_THAT(absent(120, {"a"}, {}), IsEmpty());
  EXPECT_THAT(absent(122, {"a"}, {}), ElementsAre("a"));
}

TEST_F(ReceiverPresenceTest, BeginsAnewForAReceiverThatWasForgotten) {
  EXPECT_THAT(absent(0, {"a", "b"}, {}), IsEmpty());
  EXPECT_THAT(absent(10, {"b"}, {}), IsEmpty()) << "a was released";
  EXPECT_THAT(absent(50, {"a", "b"}, {}), IsEmpty());
  EXPECT_THAT(absent(70, {"a", "b"}, {}), ElementsAre("b"));
  EXPECT_THAT(absent(90, {"a", "b"}, {}), IsEmpty());
  EXPECT_THAT(absent(111, {"a", "b"}, {}), ElementsAre("a"));
}

}  // namespace
}  // namespace fleetloc
