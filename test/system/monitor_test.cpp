// fleetloc-monitor watches a localizer and its robot over DDS, on a page.
#include <algorithm>
#include <csignal>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <string>
#include <thread>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "shared/trajectory/tum_file.hpp"
#include "test/system/dds_fixture.hpp"

// After Eigen: what it includes defines the macro _res.
#include <httplib.h>

namespace fleetloc {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

constexpr const char* kChromium = "/usr/bin/chromium";
constexpr std::chrono::seconds kPatience{30};

/// A port that nobody has at the moment.
int free_port() {
  const int descriptor = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  auto* any = reinterpret_cast<sockaddr*>(&address);
  const bool bound = bind(descriptor, any, size) == 0 && getsockname(descriptor, any, &size) == 0;
  close(descriptor);
  return bound ? ntohs(address.sin_port) : 0;
}

class MonitorPage : public DdsFixture {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    DdsFixture::SetUp();
  }

  /// The fleet as soon as it is `wanted`.
  [[nodiscard]] std::optional<json> seen(const std::function<bool(const json&)>& wanted) const {
    httplib::Client client("127.0.0.1", port_);
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    std::optional<json> found;
    while (!found && std::chrono::steady_clock::now() < deadline) {  // until it listens
      std::string events;
      client.Get("/events", [&](const char* data, std::size_t size) {
        events.append(data, size);
        for (auto end = events.find("\n\n"); end != std::string::npos; end = events.find("\n\n")) {
          const json fleet = json::parse(events.substr(6, end - 6));  // after "data: "
          events.erase(0, end + 2);
          if (!wanted(fleet)) continue;
          found = fleet;
          return false;
        }
        return std::chrono::steady_clock::now() < deadline;
      });
    }
    return found;
  }

  /// Whether the program says it sooner or later.
  [[nodiscard]] static bool says(const ChildProgram& program, const std::string& text) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (program.output().find(text) == std::string::npos) {
      if (std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return true;
  }

  /// The page in a browser once that shows `wanted`, or at last. A browser is given some seconds to
  /// start and to hear from the monitor; on a busy machine it needs more.
  [[nodiscard]] std::string looked_at(const std::string& wanted) const {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    std::string page;
    do {
      page = run(kChromium,
                 {"--headless",
                  "--no-sandbox",
                  "--disable-gpu",
                  "--timeout=4000",
                  "--dump-dom",
                  "http://127.0.0.1:" + std::to_string(port_) + "/"})
                 .output;
    } while (page.find(wanted) == std::string::npos && std::chrono::steady_clock::now() < deadline);
    return page;
  }

  const int port_ = free_port();
};

TEST_F(MonitorPage, ShowsRobotsWhereTheyAreWhileTheyAreThere) {
  const Arguments localizer = cloud("localizer_1");
  ChildProgram monitor(
      FLEETLOC_MONITOR,
      {"--domain", network_.domain(), "--http", std::to_string(port_), "--map", localizer.at(3)});
  EXPECT_TRUE(seen([](const json& fleet) { return fleet.at("localizers").empty(); }));
  ChildProgram pool(FLEETLOC_CLOUD, localizer);
  ChildProgram flying(FLEETLOC_ROBOT, robot("robot_1", {}));
  const auto fleet = seen([](const json& each) {
    return !each.at("robots").empty() && each["robots"][0].at("state") == "localized" &&
           each["robots"][0].at("up_bytes_per_s") > 100;
  });
  ASSERT_TRUE(fleet);
  std::cout << fleet->dump() << '\n';
  const json& position = fleet->at("robots").at(0).at("position");
  const Eigen::Vector3d p(position.at(0), position.at(1), position.at(2));
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const auto& pose : read_trajectory(flight_.ground_truth)) {
    nearest_m = std::min(nearest_m, (pose.T_ref_body.p - p).norm());
  }
  EXPECT_LT(nearest_m, 0.2);
  EXPECT_EQ(fleet->at("localizers").at(0).at("robots"), 1);

  httplib::Client client("127.0.0.1", port_);
  EXPECT_GT(client.Get("/map")->body.size(), 12'000U);
  EXPECT_THAT(client.Get("/")->body, HasSubstr("<title>fleetloc</title>"));
  if (std::filesystem::exists(kChromium)) {
    const std::string page = looked_at("1 robots, 1 localizers");
    EXPECT_THAT(page, HasSubstr("1 robots, 1 localizers"));
    EXPECT_THAT(page, HasSubstr("robot_1</span>"));
  } else {
    std::cout << "not looked at in a browser: there is no " << kChromium << '\n';
  }

  EXPECT_TRUE(says(monitor, "robot_1 - "));  // on the terminal, every few seconds

  pool.signal(SIGKILL);
  EXPECT_TRUE(seen(
      [](const json& each) { return each.at("robots").empty() && each.at("localizers").empty(); }));
  monitor.signal(SIGTERM);
  const Outcome watched = monitor.wait();
  EXPECT_EQ(watched.exit_code, 0) << watched.errors;
}

TEST_F(MonitorPage, SaysThatItsPortIsTaken) {
  ChildProgram first(FLEETLOC_MONITOR,
                     {"--domain", network_.domain(), "--http", std::to_string(port_)});
  ASSERT_TRUE(seen([](const json&) { return true; }));
  const Outcome second =
      run(FLEETLOC_MONITOR, {"--domain", network_.domain(), "--http", std::to_string(port_)});
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_THAT(second.errors, HasSubstr("cannot listen on 127.0.0.1:" + std::to_string(port_)));
}

}  // namespace
}  // namespace fleetloc
