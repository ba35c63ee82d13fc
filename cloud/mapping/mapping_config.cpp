#include "cloud/mapping/mapping_config.hpp"

namespace fleetloc {
namespace {

EvidenceConfig read_evidence(ConfigReader section) {
  constexpr int kMaxScans = 10000;
  constexpr int kMaxSessions = 255;
  return {.cell_m = section.positive("cell_m"),
          .scan_stride = section.integer("scan_stride", 1, kMaxScans),
          .min_margin_m = section.positive("min_margin_m"),
          .surface_margin_m = section.positive("surface_margin_m"),
          .min_cosine = section.number("min_cosine", 0.0, 1.0),
          .max_planar_sigmas = section.positive("max_sigmas_off_sheet"),
          .max_nonplanar_sigmas = section.positive("max_sigmas_off_stake"),
          .min_misses = section.integer("min_looks", 1, kMaxScans),
          .min_hit_share = section.number("min_hit_share", 0.0, 1.0),
          .min_agreement = section.number("min_agreement", 0.0, 1.0),
          .min_sessions = section.integer("min_sessions", 1, kMaxSessions)};
}

}  // namespace

MappingConfig read_mapping_config(ConfigReader config) {
  constexpr int kFewestVoxels = 1000;
  constexpr int kMaxVoxels = 1'000'000'000;
  MappingConfig mapping;
  mapping.voxel_m = config.section("map").positive("resolution_m");
  auto section = config.section("mapping");
  mapping.max_voxels =
      static_cast<std::size_t>(section.integer("max_voxels", kFewestVoxels, kMaxVoxels));
  mapping.min_range_m = section.positive("min_range_m");
  mapping.max_range_m = section.positive("max_range_m");
  if (mapping.max_range_m <= mapping.min_range_m) {
    throw ConfigError("mapping.max_range_m: must be above min_range_m");
  }
  mapping.max_gap = from_seconds(section.positive("max_gap_s"));
  mapping.evidence = read_evidence(section.section("evidence"));
  return mapping;
}

}  // namespace fleetloc
