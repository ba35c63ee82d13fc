#include "cloud/mapping/merge_sessions.hpp"

#include <sstream>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "cloud/mapping/evidence_grid.hpp"
#include "cloud/mapping/ray_evidence.hpp"
#include "cloud/point_cloud/voxel_cloud.hpp"

namespace fleetloc {
namespace {

/// Shows the scans of all sessions as one piece of work.
class PassProgress {
 public:
  PassProgress(std::string pass, const std::vector<SurveySession>& sessions, MergeProgress show)
      : pass_(std::move(pass)), show_(std::move(show)) {
    for (const SurveySession& session : sessions) total_ += session.scans();
  }

  void step() {
    ++done_;
    if (show_) show_(pass_, done_, total_);
  }

 private:
  std::string pass_;
  MergeProgress show_;
  std::size_t done_ = 0;
  std::size_t total_ = 0;
};

/// Adds the points of a scan that are neither too near nor too far.
void add_points(const std::vector<LidarRay>& rays,
                const MappingConfig& config,
                SessionCounts& counts,
                VoxelCloud& cloud) {
  counts.points += rays.size();
  for (const LidarRay& ray : rays) {
    const double range_m = (ray.p_map - ray.origin_map).norm();
    if (range_m < config.min_range_m) {
      ++counts.too_near;
    } else if (range_m > config.max_range_m) {
      ++counts.too_far;
    } else {
      cloud.add(ray.p_map);
    }
  }
}

SessionCounts add_session(const SurveySession& session,
                          const MappingConfig& config,
                          VoxelCloud& cloud,
                          PassProgress& progress) {
  SessionCounts counts{.dataset = session.dataset(), .scans = session.scans()};
  for (std::size_t i = 0; i < session.scans(); ++i) {
    if (const auto rays = session.scan(i)) {
      add_points(*rays, config, counts, cloud);
    } else {
      ++counts.scans_without_pose;
    }
    progress.step();
  }
  if (counts.scans_without_pose == counts.scans) {
    throw DatasetError((session.dataset() / "mav0").string() +
                       ": no scan lies within the poses of state_groundtruth_estimate0");
  }
  return counts;
}

void keep_stable(const RayEvidence& evidence, const EvidenceGrid& grid, MergedSessions& merged) {
  MergeReport& report = merged.report;
  std::erase_if(merged.points_map, [&](const Eigen::Vector3f& p_map) {
    const Verdict verdict = evidence.verdict(grid.find(p_map.cast<double>()).value());
    if (verdict == Verdict::kSeenThrough) ++report.seen_through;
    if (verdict == Verdict::kUnconfirmed) ++report.unconfirmed;
    return verdict != Verdict::kKept;
  });
  report.kept = merged.points_map.size();
}

}  // namespace

MergedSessions merge_sessions(const std::vector<SurveySession>& sessions,
                              const MappingConfig& config,
                              const MergeProgress& progress) {
  MergedSessions merged;
  {
    VoxelCloud cloud(config.voxel_m, config.max_voxels);
    PassProgress pass("points", sessions, progress);
    for (const SurveySession& session : sessions) {
      merged.report.sessions.push_back(add_session(session, config, cloud, pass));
    }
    merged.points_map = cloud.points();
    merged.report.voxel_m = cloud.edge_m();
    merged.report.merged = merged.points_map.size();
  }
  const EvidenceGrid grid(merged.points_map, config.evidence.cell_m);
  RayEvidence evidence(grid, config.evidence);
  PassProgress pass("rays", sessions, progress);
  for (const SurveySession& session : sessions) {
    for (std::size_t i = 0; i < session.scans(); ++i) {
      if (const auto rays = session.scan(i)) evidence.add_scan(*rays);
      pass.step();
    }
    evidence.end_session();
  }
  keep_stable(evidence, grid, merged);
  return merged;
}

std::string report_text(const MergeReport& report) {
  std::ostringstream text;
  text << "sessions:\n";
  for (const SessionCounts& session : report.sessions) {
    YAML::Emitter dataset;
    dataset << YAML::DoubleQuoted << session.dataset.string();
    text << "  - dataset: " << dataset.c_str() << "\n    scans: " << session.scans
         << "\n    scans_without_pose: " << session.scans_without_pose
         << "\n    points: " << session.points << "\n    points_too_near: " << session.too_near
         << "\n    points_too_far: " << session.too_far << '\n';
  }
  text << "voxel_m: " << report.voxel_m << "\nmerged: " << report.merged
       << "        # voxels with points\ndropped_seen_through: " << report.seen_through
       << "\ndropped_unconfirmed: " << report.unconfirmed << "\nkept: " << report.kept << '\n';
  return text.str();
}

}  // namespace fleetloc
