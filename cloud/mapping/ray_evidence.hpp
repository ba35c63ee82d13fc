#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cloud/mapping/evidence_grid.hpp"
#include "cloud/mapping/mapping_config.hpp"
#include "cloud/mapping/survey_session.hpp"

namespace fleetloc {

/// Whether a cell is kept, or why not.
enum class Verdict : std::uint8_t {
  kKept,
  kSeenThrough,  ///< contradicted by too many of the sessions that observed it
  kUnconfirmed,  ///< confirmed by too few sessions
};

/// Hits and misses of cells by the rays of one session after the other. A scan hits a cell that one
/// of its points is in, and misses one whose surface a ray passes through. A session confirms a
/// cell, contradicts it, or has not observed it.
class RayEvidence {
 public:
  /// @param grid  outlives this
  RayEvidence(const EvidenceGrid& grid, const EvidenceConfig& config);

  /// The next scan of the session. Every scan counts for hits, every `scan_stride`-th for misses.
  void add_scan(std::span<const LidarRay> rays);

  /// Decides for each cell whether the session confirms or contradicts it; the next one begins.
  void end_session();

  [[nodiscard]] Verdict verdict(std::size_t cell) const;

 private:
  /// Of one session, in scans.
  struct Counts {
    std::uint32_t last_hit = 0;   ///< number of the scan, from 1
    std::uint32_t last_miss = 0;  ///< of the scan, from 1
    std::uint16_t hits = 0;
    std::uint16_t misses = 0;
  };
  struct Sessions {
    std::uint8_t confirming = 0;
    std::uint8_t contradicting = 0;
  };

  void count_misses(const LidarRay& ray);
  [[nodiscard]] double margin_m(const LidarRay& ray) const;

  const EvidenceGrid* grid_;
  EvidenceConfig config_;
  std::uint32_t scan_ = 0;
  std::vector<Counts> counts_;
  std::vector<Sessions> sessions_;
};

}  // namespace fleetloc
