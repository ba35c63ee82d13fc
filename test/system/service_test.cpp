// fleetloc-cloud and fleetloc-robot as a service manager starts, watches, reloads and ends them.
#include <csignal>
#include <cstdlib>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/service_socket.hpp"
#include "test/system/live_fixture.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience{30};

class Service : public LiveFixture {
 protected:
  void SetUp() override {
    DdsFixture::SetUp();
    describe_sensors();
    setenv("NOTIFY_SOCKET", socket_.path().c_str(), 1);
    setenv("WATCHDOG_USEC", "400000", 1);  // children inherit both
    unsetenv("WATCHDOG_PID");
  }
  void TearDown() override {
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
  }

  /// @param reload  what it says after SIGHUP
  void expect_a_service(const std::string& program,
                        const std::vector<std::string>& arguments,
                        const std::string& reload) {
    ChildProgram service(program, arguments);
    ASSERT_TRUE(socket_.hears("READY=1", kPatience));
    ASSERT_TRUE(socket_.hears("WATCHDOG=1", kPatience));
    service.signal(SIGHUP);
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(socket_.hears("WATCHDOG=1", kPatience));
    service.signal(SIGTERM);
    ASSERT_TRUE(socket_.hears("STOPPING=1", kPatience));
    const Outcome outcome = service.wait();
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.output, HasSubstr(reload));
  }

  ServiceSocket socket_{scratch_ / "notify"};
};

TEST_F(Service, ThatLocalizes) {
  const Arguments arguments = cloud("localizer_1");
  expect_a_service(FLEETLOC_CLOUD, arguments, "SIGHUP: status.csv anew");
  EXPECT_TRUE(std::filesystem::exists(folder_of("localizer_1") / "status.csv.1"));
}

TEST_F(Service, ThatLocalizesAndWritesNothing) {
  Arguments arguments = cloud("localizer_1");
  arguments.resize(arguments.size() - 2);  // --out
  expect_a_service(FLEETLOC_CLOUD, arguments, "SIGHUP: nothing to reload");
  EXPECT_FALSE(std::filesystem::exists(folder_of("localizer_1")));
}

// As on a full disk: it cannot begin its log anew where a folder is in the way.
TEST_F(Service, ThatLocalizesGoesOnWithoutItsLog) {
  const Arguments arguments = cloud("localizer_1");
  std::filesystem::create_directories(folder_of("localizer_1") / "status.csv.1" / "in_the_way");
  expect_a_service(FLEETLOC_CLOUD, arguments, "status.csv ends here: ");
  EXPECT_TRUE(std::filesystem::exists(folder_of("localizer_1") / "sessions.json"));
}

TEST_F(Service, ThatIsARobot) {
  expect_a_service(FLEETLOC_ROBOT, robot("robot_1", {}), "SIGHUP: a new part of the run folder");
  EXPECT_GT(std::filesystem::file_size(folder_of("robot_1") / "part_000001" / "diagnostics.csv"),
            0);
  EXPECT_TRUE(std::filesystem::exists(folder_of("robot_1") / "summary.json"));
}

TEST_F(Service, ThatIsARobotWhoseSensorsAreSilent) {
  Arguments arguments = live_robot_anywhere("robot_1");
  arguments.resize(arguments.size() - 2);  // --out
  expect_a_service(FLEETLOC_ROBOT, arguments, "robot_1: live from");
  EXPECT_FALSE(std::filesystem::exists(folder_of("robot_1")));
}

}  // namespace
}  // namespace fleetloc
