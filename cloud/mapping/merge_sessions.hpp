#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "cloud/mapping/mapping_config.hpp"
#include "cloud/mapping/survey_session.hpp"

namespace fleetloc {

/// What became of one session's scans and points.
struct SessionCounts {
  std::filesystem::path dataset;
  std::size_t scans = 0;
  std::size_t scans_without_pose = 0;  ///< not covered by the poses, left out
  std::size_t points = 0;              ///< of the other scans
  std::size_t too_near = 0;
  std::size_t too_far = 0;
};

/// What became of the points of all sessions.
struct MergeReport {
  std::vector<SessionCounts> sessions;
  double voxel_m = 0.0;          ///< the configured one, or doubled
  std::size_t merged = 0;        ///< one point per voxel
  std::size_t seen_through = 0;  ///< of these, dropped: contradicted by sessions
  std::size_t unconfirmed = 0;   ///< of these, dropped: confirmed by too few sessions
  std::size_t kept = 0;
};

struct MergedSessions {
  std::vector<Eigen::Vector3f> points_map;  ///< [m]
  MergeReport report;
};

/// Called with the number of scans read so far in a pass, and of all scans.
using MergeProgress =
    std::function<void(const std::string& pass, std::size_t done, std::size_t total)>;

/// Merges the lidar scans of several sessions along the same or neighbouring routes, in one frame,
/// and keeps static structure: cells that the rays of other sessions have not passed through. Scans
/// are read twice, one at a time: once for the points, once for the rays. Memory grows with the
/// surface, not with the scans. The result depends on the files, their order and the configuration
/// alone. Throws DatasetError, also if no scan of a session lies within its poses.
MergedSessions merge_sessions(const std::vector<SurveySession>& sessions,
                              const MappingConfig& config,
                              const MergeProgress& progress = {});

/// As YAML.
std::string report_text(const MergeReport& report);

}  // namespace fleetloc
