#include "cloud/mapping/mapping_config.hpp"

#include <gmock/gmock.h>

#include "deploy/config/default_config.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

ConfigReader defaults() {
  return ConfigReader::from_string(default_config("map"), "map.yaml");
}

TEST(MappingConfig, ReadsEveryKeyOfTheDefaults) {
  auto reader = defaults();
  const MappingConfig config = read_mapping_config(reader);
  EXPECT_EQ(config.voxel_m, 0.05);
  EXPECT_EQ(config.max_gap, std::chrono::milliseconds(200));
  for (const char* key : {"normal_radius_m", "min_neighbours", "threads"}) {
    static_cast<void>(reader.section("map").get<double>(key));
  }
  EXPECT_NO_THROW(reader.expect_fully_read());
}

TEST(MappingConfig, RefusesWhatMakesNoSenseByItsName) {
  const auto expect_refused = [](const char* yaml, const char* key) {
    auto reader = defaults();
    reader.overlay(ConfigReader::from_string(yaml, "user.yaml"));
    EXPECT_THAT([&] { static_cast<void>(read_mapping_config(reader)); },
                ThrowsMessage<ConfigError>(HasSubstr(key)))
        << yaml;
  };
  expect_refused("mapping: {max_voxels: 10}", "user.yaml:1: mapping.max_voxels");
  expect_refused("mapping: {max_range_m: 0.5}", "mapping.max_range_m");
  expect_refused("mapping: {evidence: {cell_m: 0}}", "mapping.evidence.cell_m");
  expect_refused("mapping: {evidence: {min_agreement: 1.5}}", "mapping.evidence.min_agreement");
  expect_refused("mapping: {evidence: {scan_stride: often}}", "mapping.evidence.scan_stride");
}

}  // namespace
}  // namespace fleetloc
