#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/core/expected.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// How often a time that doubles with each timeout does so at most.
inline constexpr int kMaxDoublings = 16;

/// Why the status of a localizer is ignored.
enum class StatusRefusal {
  kOutdated,  ///< of an earlier incarnation
  kConflict,  ///< two incarnations are alive: two localizers have one name
};

/// Name in logs and summary.json, e.g. "conflicting_localizer".
std::string_view name(StatusRefusal refusal);

/// A number that two names always give and that is evenly distributed, on every machine.
std::uint64_t rendezvous_hash(std::string_view robot, std::string_view localizer);

/// What one robot knows of the localizers, and which of them it would choose. Among those that
/// accept robots, have the right map, and have about as little load and as few robots as any, a
/// hash of robot and localizer decides (rendezvous hashing), so that a fleet spreads, also when
/// many robots choose at one moment.
class KnownLocalizers {
 public:
  struct Config {
    double status_timeout_s;  ///< without LocalizerStatus for longer: gone
    double exclusion_s;       ///< after a timeout; doubles each time
    double max_exclusion_s;
  };
  struct Localizer {
    LocalizerStatus status;
    Timestamp heard;
    std::optional<Timestamp> older_heard;  // status of an earlier incarnation
    Timestamp excluded_until{Timestamp::min()};
    int timeouts = 0;  // since its last answer
  };
  using Names = std::initializer_list<std::string_view>;
  /// Which ones may be chosen.
  enum class Range {
    kFit,       ///< those that accept robots and have not timed out lately
    kExcluded,  ///< also those that have timed out
    kFull,      ///< those that accept no robots: it is up to them
  };

  KnownLocalizers(std::string_view robot, const Config& config);

  /// @param kept  are not forgotten, however many others there are
  expected<void, StatusRefusal> update(const LocalizerStatus& status, Names kept, Timestamp now);

  /// Expects that there was a status.
  [[nodiscard]] const Localizer& at(const std::string& name) const { return known_.at(name); }

  void answered(const std::string& name) { known_.at(name).timeouts = 0; }
  /// It is avoided for a while, as long as there is another one.
  void exclude(const std::string& name, Timestamp now);

  /// From now on only localizers with this map are candidates.
  void require_map(const MapHash& map) { map_ = map; }
  [[nodiscard]] bool accepts_map(const MapHash& map) const { return !map_ || *map_ == map; }

  [[nodiscard]] bool is_alive(const Localizer& localizer, Timestamp now) const;

  /// The one to choose; nullptr if there is none.
  /// @param but  those in use
  [[nodiscard]] const Localizer* best(Names but, Timestamp now, Range range = Range::kFit) const;

  /// Those that may be chosen next, the likeliest one first, whatever their load is at present.
  [[nodiscard]] std::vector<std::string> standbys(std::size_t count,
                                                  std::string_view but,
                                                  Timestamp now) const;

  /// A localizer that accepts robots but has another map; empty if there is none.
  [[nodiscard]] std::string with_other_map(Timestamp now) const;

 private:
  [[nodiscard]] bool is_candidate(const Localizer& localizer,
                                  Names but,
                                  Timestamp now,
                                  Range range) const;

  std::string robot_;
  Config config_;
  std::map<std::string, Localizer> known_;
  std::optional<MapHash> map_;
};

}  // namespace fleetloc
