#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cloud/mapping/evidence_grid.hpp"
#include "cloud/mapping/mapping_config.hpp"
#include "cloud/mapping/survey_session.hpp"

namespace fleetloc {

/// What is to become of a cell.
enum class Verdict : std::uint8_t {
  kKept,
  kSeenThrough,  ///< too many of the sessions that looked found nothing there
  kUnconfirmed,  ///< too few sessions have seen it
};

/// Collects what the rays of the sessions, one after the other, say of the cells. A scan looks at a
/// cell by hitting something in it, or by a ray that passes where the cell's surface would be. One
/// session confirms a cell, contradicts it, or has not looked.
class RayEvidence {
 public:
  /// @param grid  outlives this
  RayEvidence(const EvidenceGrid& grid, const EvidenceConfig& config);

  /// The next scan of the session. Every scan counts for hits, every `scan_stride`-th for looking
  /// through.
  void add_scan(std::span<const Sighting> sightings);

  /// What the session has said is weighed; the next one begins.
  void end_session();

  [[nodiscard]] Verdict verdict(std::size_t cell) const;

 private:
  /// Of one session, in scans.
  struct Looks {
    std::uint32_t last_hit = 0;      ///< number of the scan, from 1
    std::uint32_t last_through = 0;  ///< the same
    std::uint16_t hits = 0;
    std::uint16_t throughs = 0;
  };
  struct Sessions {
    std::uint8_t confirming = 0;
    std::uint8_t contradicting = 0;
  };

  void look_through(const Sighting& sighting);
  [[nodiscard]] double margin_m(const Sighting& sighting) const;

  const EvidenceGrid* grid_;
  EvidenceConfig config_;
  std::uint32_t scan_ = 0;
  std::vector<Looks> looks_;
  std::vector<Sessions> sessions_;
};

}  // namespace fleetloc
