#include "cloud/laser_map/map_regions.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

MapRegions regions_of(const std::string& yaml) {
  return read_map_regions(ConfigReader::from_string(yaml, "hall.regions.yaml"));
}

TEST(MapRegions, AreRectanglesCirclesAndStoreys) {
  const MapRegions regions = regions_of(
      "yard: {rectangle: [-10, 0, 20, 5]}\n"
      "gate: {circle: [3, 4, 2]}\n"
      "floor_2: {heights: [3.5, 6.5]}\n"
      "office: {rectangle: [0, 0, 4, 4], heights: [3.5, 6.5]}\n");
  const auto has = [&](const char* region, const Eigen::Vector3d& p, double margin_m = 0.0) {
    return regions.at(region).has(p.head<2>(), margin_m) &&
           regions.at(region).has_storey(p.z(), margin_m);
  };
  EXPECT_EQ(regions.size(), 4U);
  EXPECT_TRUE(has("yard", {19.0, 1.0, 100.0}));
  EXPECT_FALSE(has("yard", {21.0, 1.0, 0.0}));
  EXPECT_TRUE(has("yard", {21.0, 1.0, 0.0}, 1.5));
  EXPECT_TRUE(has("gate", {4.3, 5.3, 0.0}));
  EXPECT_FALSE(has("gate", {4.9, 5.9, 0.0})) << "a corner of the square around it";
  EXPECT_TRUE(has("gate", {4.9, 5.9, 0.0}, 1.0));
  EXPECT_TRUE(has("floor_2", {1e4, 0.0, 4.0}));
  EXPECT_FALSE(has("floor_2", {1e4, 0.0, 3.0}));
  EXPECT_TRUE(has("floor_2", {1e4, 0.0, 3.0}, 0.6));
  EXPECT_TRUE(has("office", {1.0, 1.0, 4.0}));
  EXPECT_FALSE(has("office", {1.0, 1.0, 0.0}));
  EXPECT_FALSE(has("office", {5.0, 1.0, 4.0}));
}

TEST(MapRegions, NowhereHasNothing) {
  for (const double x : {-1e7, 0.0, 1e7}) {
    EXPECT_FALSE(MapRegion::nowhere().has({x, x}, 10.0)) << x;
  }
}

void expect_no_region(const std::string& yaml, const std::string& why) {
  try {
    regions_of(yaml);
    FAIL() << yaml;
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("hall.regions.yaml:1"), HasSubstr(why))) << yaml;
  }
}

TEST(MapRegions, ThatSayNothingOrTooMuchAreNamed) {
  expect_no_region("a: {circle: [1, 2]}", "a.circle: expected [x, y, radius] in m");
  expect_no_region("a: {circle: [1, 2, .nan]}", "a.circle: expected [x, y, radius] in m");
  expect_no_region("a: {circle: [1, 2, 0]}", "a.circle: is empty");
  expect_no_region("a: {rectangle: [1, 2, 1, 3]}", "a.rectangle: is empty");
  expect_no_region("a: {rectangle: [1, 2, 3]}", "expected [x_min, y_min, x_max, y_max] in m");
  expect_no_region("a: {heights: [2, 1]}", "a.heights: is empty");
  expect_no_region("a: {circle: [1, 2, 3], rectangle: [1, 2, 3, 4]}", "there is a rectangle, too");
  expect_no_region("a: {polygon: [1, 2, 3]}", "polygon");
  expect_no_region("a: 7", "expected a section");
  expect_no_region("hall B: {circle: [1, 2, 3]}", "is not 1 to 32 of A-Z a-z 0-9 _ -");
}

TEST(MapRegions, AreInAFileBesideTheMap) {
  const std::filesystem::path folder = test_folder() / "regions";
  std::filesystem::create_directories(folder);
  EXPECT_TRUE(load_map_regions(folder / "hall.pcd").empty()) << "there need not be one";
  std::ofstream(folder / "hall.regions.yaml") << "gate: {circle: [3, 4, 2]}\n";
  EXPECT_EQ(load_map_regions(folder / "hall.pcd").count("gate"), 1U);
}

}  // namespace
}  // namespace fleetloc
