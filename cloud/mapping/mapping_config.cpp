#include "cloud/mapping/mapping_config.hpp"

namespace fleetloc {
namespace {

EvidenceConfig read_evidence(ConfigReader section) {
  constexpr int kMostScans = 10000;
  constexpr int kMostSessions = 255;
  return {.cell_m = section.positive("cell_m"),
          .scan_stride = section.integer("scan_stride", 1, kMostScans),
          .least_margin_m = section.positive("least_margin_m"),
          .surface_margin_m = section.positive("surface_margin_m"),
          .least_cosine = section.number("least_cosine", 0.0, 1.0),
          .most_sigmas_off_sheet = section.positive("most_sigmas_off_sheet"),
          .most_sigmas_off_stake = section.positive("most_sigmas_off_stake"),
          .least_looks = section.integer("least_looks", 1, kMostScans),
          .least_hit_share = section.number("least_hit_share", 0.0, 1.0),
          .least_agreement = section.number("least_agreement", 0.0, 1.0),
          .least_sessions = section.integer("least_sessions", 1, kMostSessions)};
}

}  // namespace

MappingConfig read_mapping_config(ConfigReader config) {
  constexpr int kFewestVoxels = 1000;
  constexpr int kMostVoxels = 1'000'000'000;
  MappingConfig mapping;
  mapping.voxel_m = config.section("map").positive("resolution_m");
  auto section = config.section("mapping");
  mapping.most_voxels =
      static_cast<std::size_t>(section.integer("most_voxels", kFewestVoxels, kMostVoxels));
  mapping.least_range_m = section.positive("least_range_m");
  mapping.most_range_m = section.positive("most_range_m");
  if (mapping.most_range_m <= mapping.least_range_m) {
    throw ConfigError("mapping.most_range_m: must be above least_range_m");
  }
  mapping.max_gap = from_seconds(section.positive("max_gap_s"));
  mapping.evidence = read_evidence(section.section("evidence"));
  return mapping;
}

}  // namespace fleetloc
