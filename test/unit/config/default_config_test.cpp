#include "shared/config/default_config.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

TEST(DefaultConfig, IsTheFileInDeploy) {
  auto built_in = ConfigReader::from_string(default_config("robot"));
  auto file = ConfigReader::from_file(FLEETLOC_SOURCE_DIR "/deploy/config/robot.yaml");
  EXPECT_EQ(built_in.section("dds").integer("domain", 0, 100),
            file.section("dds").integer("domain", 0, 100));
}

TEST(DefaultConfig, TakesTheUsersValuesOnTop) {
  auto config = ConfigReader::from_string(default_config("robot"), "robot.yaml");
  config.overlay(ConfigReader::from_string("dds: {domain: 7}"));
  EXPECT_EQ(config.section("dds").integer("domain", 0, 100), 7);
}

TEST(DefaultConfig, OfAnUnknownProgramDoesNotExist) {
  EXPECT_THROW(default_config("toaster"), std::out_of_range);
}

}  // namespace
}  // namespace fleetloc
