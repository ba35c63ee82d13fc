#include "shared/transport/workarounds/start_gate.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

struct StartGateTest : testing::Test {
  void hold(int number) {
    gate.hold([this, number] { sent.push_back(number); });
  }
  StartGate gate;
  std::vector<int> sent;
};

TEST_F(StartGateTest, IsOpenBeforeAnyParticipantStarts) {
  EXPECT_FALSE(gate.is_closed());
  hold(1);
  EXPECT_THAT(sent, ElementsAre(1));
}

TEST_F(StartGateTest, SendsOnceAndInOrderWhatWasHeld) {
  gate.close();
  EXPECT_TRUE(gate.is_closed());
  hold(1);
  hold(2);
  EXPECT_THAT(sent, IsEmpty());
  gate.open();
  EXPECT_THAT(sent, ElementsAre(1, 2));
  gate.close();
  gate.open();
  EXPECT_THAT(sent, ElementsAre(1, 2));
}

// Its sockets are gone.
TEST_F(StartGateTest, DropsWhatWasHeldForAParticipantThatFailed) {
  gate.close();
  hold(1);
  gate.close();
  hold(2);
  gate.open();
  EXPECT_THAT(sent, ElementsAre(2));
}

TEST_F(StartGateTest, SendsWhatIsHeldWhileItIsBeingOpened) {
  gate.close();
  gate.hold([this] { hold(1); });
  gate.open();
  EXPECT_THAT(sent, ElementsAre(1));
}

}  // namespace
}  // namespace fleetloc
