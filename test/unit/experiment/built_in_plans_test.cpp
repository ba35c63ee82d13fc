#include <filesystem>

#include <gmock/gmock.h>

#include "deploy/evaluation/experiment/plan.hpp"
#include "deploy/sim/motion/motion_config.hpp"

namespace fleetloc {
namespace {

const std::filesystem::path kDeploy = std::filesystem::path(FLEETLOC_SOURCE_DIR) / "deploy";

TEST(BuiltInPlans, CanAllBeRead) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kDeploy / "experiments")) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path());
    EXPECT_NO_THROW(read_plan(entry.path(), [](const ConfigReader&) {}));
    ++count;
  }
  EXPECT_GE(count, 5U);
}

TEST(BuiltInLinks, CanAllBeRead) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kDeploy / "experiments" / "links")) {
    SCOPED_TRACE(entry.path());
    EXPECT_NO_THROW(read_link_file(entry.path()));
    ++count;
  }
  EXPECT_EQ(count, 8U);
}

TEST(BuiltInPlans, DriveTheRingBothWays) {
  const WaypointRoute ring = read_route(kDeploy / "worlds" / "ring.yaml");
  WaypointRoute reversed = read_route(kDeploy / "worlds" / "ring-reversed.yaml");
  EXPECT_FALSE(ring.reverse);
  EXPECT_TRUE(reversed.reverse);
  reversed.reverse = false;
  EXPECT_EQ(driven_waypoints(ring), driven_waypoints(reversed));
}

}  // namespace
}  // namespace fleetloc
