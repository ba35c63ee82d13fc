#include "shared/service/service_manager.hpp"

#include <cstdlib>

#include <gtest/gtest.h>

#include "test/service_socket.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

class ServiceManagerTest : public testing::Test {
 protected:
  ServiceManagerTest() {
    setenv("NOTIFY_SOCKET", socket_.path().c_str(), 1);
    setenv("WATCHDOG_USEC", "20000000", 1);
    unsetenv("WATCHDOG_PID");
  }
  ~ServiceManagerTest() override {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
  }

  ServiceSocket socket_{test_folder() / "notify"};
};

TEST_F(ServiceManagerTest, IsToldThatTheProgramServesAndThatItEnds) {
  ServiceManager manager;
  manager.ready();
  EXPECT_EQ(socket_.next(), "READY=1");
  manager.stopping();
  EXPECT_EQ(socket_.next(), "STOPPING=1");
}

TEST_F(ServiceManagerTest, HearsFourTimesInItsIntervalAsLongAsTheLoopGoesRound) {
  ServiceManager manager;
  ArrivalTime now{1h};
  int heard = 0;
  for (int i = 0; i < 2000; ++i, now += 10ms) {  // 20 s
    manager.alive(now);
    while (socket_.next() == "WATCHDOG=1") ++heard;
  }
  EXPECT_EQ(heard, 4);
  EXPECT_FALSE(socket_.next()) << "nothing by itself: a loop that hangs is noticed";
}

TEST_F(ServiceManagerTest, HearsOfChangesOnceASecondAtMost) {
  ServiceManager manager;
  const ArrivalTime begin{1h};
  manager.status("lost", begin);
  manager.status("lost", begin + 2s);
  manager.status("localized", begin + 2s);
  manager.status("lost", begin + 2500ms);
  manager.status("dead_reckoning", begin + 3s);
  EXPECT_EQ(socket_.next(), "STATUS=lost");
  EXPECT_EQ(socket_.next(), "STATUS=localized");
  EXPECT_EQ(socket_.next(), "STATUS=dead_reckoning");
  EXPECT_FALSE(socket_.next());
}

TEST_F(ServiceManagerTest, HearsOfNoLoopIfItDoesNotWatch) {
  unsetenv("WATCHDOG_USEC");
  ServiceManager manager;
  manager.alive(ArrivalTime{1h});
  EXPECT_FALSE(socket_.next());
}

TEST(NoServiceManager, IsTold) {
  ServiceManager manager;
  manager.ready();
  manager.alive(ArrivalTime{1h});
  manager.status("lost", ArrivalTime{1h});
  manager.stopping();
}

}  // namespace
}  // namespace fleetloc
