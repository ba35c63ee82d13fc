#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "shared/core/expected.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

class ConfigReader;

/// Why the status of a localizer is ignored.
enum class StatusRefusal {
  kOutdated,  ///< of an earlier incarnation
  kConflict,  ///< two incarnations are alive: two localizers have one name
};

/// Name in logs and summary.json, e.g. "conflicting_localizer".
std::string_view name(StatusRefusal refusal);

/// Selects the localizer of a robot from LocalizerStatus and from the answers that arrive. Among
/// those that accept robots, have the right map and are not much more loaded than others, a hash of
/// robot and localizer decides (rendezvous hashing), so that a fleet spreads.
///
/// Failover: when answers time out, the robot switches to another localizer, if there is one. The
/// one that timed out is excluded for a time that doubles with each timeout, unless there is no
/// other. Load balancing: the robot leaves an overloaded localizer only for one with clearly less
/// load, each robot after a delay of its own. Deterministic, no clock.
class LocalizerSelector {
 public:
  struct Config {
    double answer_timeout_s;     ///< without an answer, on top of the round trips below
    double timeout_round_trips;  ///< of the measured length
    double max_timeout_s;        ///< doubles with every switch without an answer since
    double status_timeout_s;     ///< without LocalizerStatus for longer: gone
    double exclusion_s;          ///< after a timeout; doubles each time
    double max_exclusion_s;
    double overload;         ///< load from which on a robot may switch
    double min_load_gain;    ///< smallest difference of loads for a switch
    double load_patience_s;  ///< how long it must last; up to twice, by robot
  };
  /// Measured properties of the link to the chosen localizer.
  struct Link {
    std::optional<Duration> round_trip;
    double loss = 0.0;  ///< share of samples, 0..1
  };
  enum class Change {
    kNone,
    kChosen,     ///< another localizer than before
    kRestarted,  ///< the same one, which has lost all sessions
    kLeft,       ///< there is none now
  };

  LocalizerSelector(std::string_view robot, const Config& config);

  expected<void, StatusRefusal> update(const LocalizerStatus& status, Timestamp now);

  /// A submap was sent to the chosen localizer: an answer is expected.
  void sent(Timestamp now);
  void answered(Timestamp now);

  /// From now on only localizers with this map are used: the robot's map poses refer to it.
  void require_map(const MapHash& map) { map_ = map; }
  [[nodiscard]] bool accepts_map(const MapHash& map) const { return !map_ || *map_ == map; }

  /// Evaluates timeouts and loads; to be called regularly.
  Change decide(Timestamp now, const Link& link);

  /// The others that it would choose next, the best one first.
  [[nodiscard]] std::vector<std::string> standbys(std::size_t count, Timestamp now) const;

  [[nodiscard]] const std::string& name() const { return name_; }         ///< empty: none
  [[nodiscard]] Incarnation incarnation() const { return incarnation_; }  ///< of the chosen one
  /// Why the last change happened, as text for a log.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// Text for a log while the chosen localizer fails and there is no other; else empty.
  [[nodiscard]] const std::string& warning() const { return warning_; }
  /// A localizer that accepts robots but has another map; empty if there is none.
  [[nodiscard]] std::string_view other_map() const { return other_map_; }

 private:
  struct Known {
    LocalizerStatus status;
    Timestamp heard;
    std::optional<Timestamp> older_heard;  // status of an earlier incarnation
    Timestamp excluded_until{Timestamp::min()};
    int consecutive_timeouts = 0;  // since its last answer
  };
  using Candidate = std::map<std::string, Known>::iterator;

  [[nodiscard]] bool is_alive(const Known& known, Timestamp now) const;
  [[nodiscard]] bool is_candidate(const Known& known, Timestamp now, bool even_excluded) const;
  Candidate best(Timestamp now, bool even_excluded);
  [[nodiscard]] bool is_silent(Timestamp now, const Link& link) const;
  [[nodiscard]] bool is_overloaded_for_long(const Known& current,
                                            const Known& other,
                                            Timestamp now);
  Change choose_first(Timestamp now);
  Change follow_restart(const Known& current, Timestamp now);
  Change choose(Candidate candidate, std::string reason, Timestamp now);
  Change leave_unresponsive(Known& current, Candidate other, std::string reason, Timestamp now);
  Change leave(std::string reason);
  void erase_stalest();

  std::string robot_;
  Config config_;
  std::map<std::string, Known> known_;
  std::optional<MapHash> map_;
  std::string name_;
  Incarnation incarnation_{};
  bool has_answered_ = false;               // since it was chosen
  std::optional<Timestamp> waiting_since_;  // for an answer
  Timestamp last_activity_;                 // when it was chosen, or its last answer
  std::optional<Timestamp> overloaded_since_;
  int consecutive_timeouts_ = 0;  // switches without an answer since
  std::string reason_;
  std::string warning_;
  std::string other_map_;
};

LocalizerSelector::Config read_localizer_selector_config(ConfigReader config);

}  // namespace fleetloc
