#include "deploy/config/default_config.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

TEST(DefaultConfig, IsTheFileInDeploy) {
  auto built_in = ConfigReader::from_string(default_config("robot"));
  auto file = ConfigReader::from_file(FLEETLOC_SOURCE_DIR "/deploy/config/robot.yaml");
  EXPECT_EQ(built_in.section("start").positive("yaw_sigma_deg"),
            file.section("start").positive("yaw_sigma_deg"));
}

TEST(DefaultConfig, TakesTheUsersValuesOnTop) {
  auto config = ConfigReader::from_string(default_config("robot"), "robot.yaml");
  config.overlay(ConfigReader::from_string("start: {yaw_sigma_deg: 7}"));
  EXPECT_EQ(config.section("start").positive("yaw_sigma_deg"), 7.0);
}

TEST(DefaultConfig, OfEverythingHasTheSectionsOfAllPrograms) {
  auto config = ConfigReader::from_string(default_config("everything"));
  EXPECT_GT(config.section("start").positive("yaw_sigma_deg"), 0.0);
  EXPECT_GT(config.section("pool").positive("idle_session_s"), 0.0);
  EXPECT_GT(config.section("replay").positive("back_end_s"), 0.0);
}

TEST(DefaultConfig, OfAnUnknownProgramDoesNotExist) {
  EXPECT_THROW(default_config("toaster"), std::out_of_range);
}

}  // namespace
}  // namespace fleetloc
