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

/// The part of a ray that shows what it passes as free.
struct FreeWay {
  Eigen::Vector3d from_map;
  Eigen::Vector3d direction;  // unit
  double length_m = 0.0;
};

/// The ray passes where the cell's surface would stop it: where it crosses a sheet, or comes
/// nearest to the middle of what is no sheet, there are points of the cell around.
bool passes_through(const FreeWay& way, const SurfaceCell& cell, const EvidenceConfig& config) {
  if (cell.kind == SurfaceCell::Kind::kUnknown) return false;
  const Eigen::Vector3d to_cell = cell.p_map.cast<double>() - way.from_map;
  double along_m = to_cell.dot(way.direction);
  double max_sigmas = config.max_sigmas_off_stake;
  if (cell.kind == SurfaceCell::Kind::kSheet) {
    const Eigen::Vector3d normal = cell.normal.cast<double>();
    const double cosine = normal.dot(way.direction);
    if (std::abs(cosine) < config.min_cosine) return false;
    along_m = normal.dot(to_cell) / cosine;
    max_sigmas = config.max_sigmas_off_sheet;
  }
  if (along_m < 0.0 || along_m > way.length_m) return false;
  const Eigen::Vector3f off = (along_m * way.direction - to_cell).cast<float>();
  return static_cast<double>(off.dot(cell.information * off)) <= max_sigmas * max_sigmas;
}

}  // namespace

RayEvidence::RayEvidence(const EvidenceGrid& grid, const EvidenceConfig& config)
    : grid_(&grid), config_(config), looks_(grid.size()), sessions_(grid.size()) {}

void RayEvidence::add_scan(std::span<const Sighting> sightings) {
  ++scan_;
  for (const Sighting& sighting : sightings) {
    const auto index = grid_->find(sighting.p_map);
    if (!index) continue;
    Looks& looks = looks_[*index];
    if (looks.last_hit == scan_) continue;
    looks.last_hit = scan_;
    count_up(looks.hits);
  }
  if ((scan_ - 1) % static_cast<std::uint32_t>(config_.scan_stride) != 0) return;
  for (const Sighting& sighting : sightings) look_through(sighting);
}

void RayEvidence::look_through(const Sighting& sighting) {
  const Eigen::Vector3d ray = sighting.p_map - sighting.from_map;
  const double range_m = ray.norm();
  const double free_m = range_m - margin_m(sighting);
  if (!(free_m > 0.0)) return;
  const FreeWay way{.from_map = sighting.from_map, .direction = ray / range_m, .length_m = free_m};
  grid_->walk(way.from_map, way.from_map + free_m * way.direction, [&](std::size_t index) {
    Looks& looks = looks_[index];
    if (looks.last_hit == scan_ || looks.last_through == scan_) return;
    if (!passes_through(way, grid_->cell(index), config_)) return;
    looks.last_through = scan_;
    count_up(looks.throughs);
  });
}

double RayEvidence::margin_m(const Sighting& sighting) const {
  constexpr double kMinCosine = 0.02;
  double cosine = config_.min_cosine;  // where the surface is not known
  if (const auto hit = grid_->find(sighting.p_map)) {
    const SurfaceCell& cell = grid_->cell(*hit);
    if (cell.kind == SurfaceCell::Kind::kSheet) {
      const Eigen::Vector3d ray = (sighting.p_map - sighting.from_map).normalized();
      cosine = std::max(kMinCosine, std::abs(cell.normal.cast<double>().dot(ray)));
    }
  }
  return config_.min_margin_m + config_.surface_margin_m / cosine;
}

void RayEvidence::end_session() {
  for (std::size_t i = 0; i < looks_.size(); ++i) {
    const Looks looks = looks_[i];
    looks_[i] = {};
    const double hits = looks.hits;
    const double all = hits + static_cast<double>(looks.throughs) * config_.scan_stride;
    const bool contradicts =
        looks.throughs >= config_.min_looks && hits < config_.min_hit_share * all;
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
  const int looked = sessions.confirming + sessions.contradicting;
  if (sessions.confirming < config_.min_agreement * looked) return Verdict::kSeenThrough;
  if (sessions.confirming < config_.min_sessions) return Verdict::kUnconfirmed;
  return Verdict::kKept;
}

}  // namespace fleetloc
