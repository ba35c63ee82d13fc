#include "cloud/mapping/ray_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fleetloc {
namespace {

template <typename Count>
void count_up(Count& count) {
  if (count < std::numeric_limits<Count>::max()) ++count;
}

/// The part of a ray that is known to be free.
struct FreeSegment {
  Eigen::Vector3d origin_map;
  Eigen::Vector3d direction;  // unit
  double length_m = 0.0;
};

/// Whether the ray passes through the cell's surface: where it crosses the plane, or is nearest to
/// the mean of a non-planar cell, it is within `max_sigmas` of the cell's points.
bool passes_through(const FreeSegment& segment,
                    const SurfaceCell& cell,
                    const EvidenceConfig& config) {
  if (cell.kind == SurfaceCell::Kind::kUnknown) return false;
  const Eigen::Vector3d to_cell = cell.p_map.cast<double>() - segment.origin_map;
  double along_m = to_cell.dot(segment.direction);
  double max_sigmas = config.max_nonplanar_sigmas;
  if (cell.kind == SurfaceCell::Kind::kPlanar) {
    const Eigen::Vector3d normal = cell.normal.cast<double>();
    const double cosine = normal.dot(segment.direction);
    if (std::abs(cosine) < config.min_cosine) return false;
    along_m = normal.dot(to_cell) / cosine;
    max_sigmas = config.max_planar_sigmas;
  }
  if (along_m < 0.0 || along_m > segment.length_m) return false;
  const Eigen::Vector3f off = (along_m * segment.direction - to_cell).cast<float>();
  return static_cast<double>(off.dot(cell.information * off)) <= max_sigmas * max_sigmas;
}

}  // namespace

RayEvidence::RayEvidence(const EvidenceGrid& grid, const EvidenceConfig& config)
    : grid_(&grid), config_(config), counts_(grid.size()), sessions_(grid.size()) {}

void RayEvidence::add_scan(std::span<const LidarRay> rays) {
  ++scan_;
  for (const LidarRay& ray : rays) {
    const auto index = grid_->find(ray.p_map);
    if (!index) continue;
    Counts& counts = counts_[*index];
    if (counts.last_hit == scan_) continue;
    counts.last_hit = scan_;
    count_up(counts.hits);
  }
  if ((scan_ - 1) % static_cast<std::uint32_t>(config_.scan_stride) != 0) return;
  for (const LidarRay& ray : rays) count_misses(ray);
}

void RayEvidence::count_misses(const LidarRay& ray) {
  const Eigen::Vector3d along = ray.p_map - ray.origin_map;
  const double range_m = along.norm();
  const double free_m = range_m - margin_m(ray);
  if (!(free_m > 0.0)) return;
  const FreeSegment segment{
      .origin_map = ray.origin_map, .direction = along / range_m, .length_m = free_m};
  grid_->traverse(
      segment.origin_map, segment.origin_map + free_m * segment.direction, [&](std::size_t index) {
        Counts& counts = counts_[index];
        if (counts.last_hit == scan_ || counts.last_miss == scan_) return;
        if (!passes_through(segment, grid_->cell(index), config_)) return;
        counts.last_miss = scan_;
        count_up(counts.misses);
      });
}

double RayEvidence::margin_m(const LidarRay& ray) const {
  constexpr double kMinCosine = 0.02;
  double cosine = config_.min_cosine;  // where the surface is not known
  if (const auto hit = grid_->find(ray.p_map)) {
    const SurfaceCell& cell = grid_->cell(*hit);
    if (cell.kind == SurfaceCell::Kind::kPlanar) {
      const Eigen::Vector3d along = (ray.p_map - ray.origin_map).normalized();
      cosine = std::max(kMinCosine, std::abs(cell.normal.cast<double>().dot(along)));
    }
  }
  return config_.min_margin_m + config_.surface_margin_m / cosine;
}

void RayEvidence::end_session() {
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const Counts counts = counts_[i];
    counts_[i] = {};
    const double hits = counts.hits;
    const double all = hits + static_cast<double>(counts.misses) * config_.scan_stride;
    const bool contradicts =
        counts.misses >= config_.min_misses && hits < config_.min_hit_share * all;
    if (contradicts) {
      count_up(sessions_[i].contradicting);
    } else if (hits > 0.0) {
      count_up(sessions_[i].confirming);
    }
  }
  scan_ = 0;
}

Verdict RayEvidence::verdict(std::size_t cell) const {
  const Sessions& sessions = sessions_[cell];
  const int observing = sessions.confirming + sessions.contradicting;
  if (sessions.confirming < config_.min_agreement * observing) return Verdict::kSeenThrough;
  if (sessions.confirming < config_.min_sessions) return Verdict::kUnconfirmed;
  return Verdict::kKept;
}

}  // namespace fleetloc
