#include "cloud/node/status_log.hpp"

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cloud/laser_map/build_map.hpp"
#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"
#include "test/test_folder.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

class StatusLogTest : public testing::Test {
 protected:
  [[nodiscard]] static std::vector<std::string> lines_of(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }

  static ConfigReader cloud_defaults() {
    return ConfigReader::from_string(default_config("cloud"));
  }

  std::filesystem::path file_ = test_folder() / "status.csv";
  std::filesystem::path before_ = test_folder() / "status.csv.1";
  LocalizerPool pool_{
      "localizer",
      Incarnation{3},
      std::make_shared<const LaserMap>(build_map(
          {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
          "map",
          read_map_config(ConfigReader::from_string(default_config("everything")).section("map")))),
      read_localizer_pool_config(cloud_defaults())};
  StatusLog log_{file_, at_ms(0)};
};

TEST_F(StatusLogTest, HasALineASecond) {  // of a localizer that has no workers yet
  for (int ms = 0; ms < 3000; ms += 100) log_.add(pool_, 0.5, at_ms(ms));
  EXPECT_EQ(lines_of(file_),
            (std::vector<std::string>{"time_s,sessions,load,submaps,localized,state",
                                      "0,0,0.5,0,0,full",
                                      "1,0,0.5,0,0,full",
                                      "2,0,0.5,0,0,full"}));
}

TEST_F(StatusLogTest, BeginsAnewWhereItTakesTwentyMegabytesAndKeepsTheOneBefore) {
  std::filesystem::remove(before_);
  for (int s = 0; !std::filesystem::exists(before_) && s < 1'000'000; s += 100) {
    for (int i = 0; i < 100; ++i) log_.add(pool_, 0.123456, at(s + i));
  }
  ASSERT_TRUE(std::filesystem::exists(before_));
  EXPECT_NEAR(static_cast<double>(std::filesystem::file_size(before_)), 20e6, 100.0);
  EXPECT_LE(lines_of(file_).size(), 101U);
  EXPECT_EQ(lines_of(file_).front(), lines_of(before_).front());
}

}  // namespace
}  // namespace fleetloc
