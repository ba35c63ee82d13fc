#include "robot/cloud_client/localizer_connections.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class PreparedReceivers final : public Channel {
 public:
  void send(const std::string& /*receiver*/, Message /*message*/, Timestamp /*now*/) override {}
  [[nodiscard]] std::vector<Message> receive(Timestamp /*now*/) override { return {}; }
  [[nodiscard]] ChannelStatistics statistics() const override { return {}; }
  void prepare(const std::string& receiver) override { calls.push_back("+" + receiver); }
  void release(const std::string& receiver) override { calls.push_back("-" + receiver); }

  std::vector<std::string> calls;
};

class LocalizerConnectionsTest : public testing::Test {
 protected:
  PreparedReceivers channel_;
  LocalizerConnections connections_{channel_, {.standbys = 2, .linger_s = 10.0}};
};

TEST_F(LocalizerConnectionsTest, ArePreparedOnceForEachThatIsWanted) {
  EXPECT_THAT(connections_.keep({"a", "b"}, at(0)), ElementsAre("a", "b"));
  for (int s = 1; s < 100; ++s) {
    EXPECT_THAT(connections_.keep({"a", "b"}, at(s)), IsEmpty());
  }
  EXPECT_THAT(connections_.keep({"b", "c"}, at(100)), ElementsAre("c"));
  EXPECT_THAT(channel_.calls, ElementsAre("+a", "+b", "+c"));
}

TEST_F(LocalizerConnectionsTest, LastForAWhileAfterTheyWereWanted) {
  connections_.keep({"a", "b"}, at(0));
  connections_.keep({"b"}, at(9));
  EXPECT_THAT(connections_.keep({"a", "b"}, at(10)), IsEmpty()) << "wanted again";
  connections_.keep({"b"}, at(20));
  EXPECT_THAT(channel_.calls, ElementsAre("+a", "+b"));
  connections_.keep({"b"}, at(21));
  EXPECT_THAT(channel_.calls, ElementsAre("+a", "+b", "-a"));
  EXPECT_THAT(connections_.keep({"a"}, at(22)), ElementsAre("a"));
}

}  // namespace
}  // namespace fleetloc
