#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "shared/model/session.hpp"

namespace fleetloc {

class ConfigReader;

/// Which localizer a robot uses, from what the localizers say of themselves and from whether
/// answers come. Of those that accept robots, have the right map and are not much more loaded than
/// others, each robot prefers another one, always the same, so that a fleet spreads.
///
/// Failover: a robot moves when answers stop, at once if there is another localizer; the silent one
/// is then avoided for a while, the longer the more often it has failed, but used if there is no
/// other. For the sake of load it moves only from an overloaded localizer to one with clearly less,
/// and robots do so at different times. Deterministic, no clock.
class LocalizerSelector {
 public:
  struct Config {
    double answer_timeout_s;     ///< without answers, beyond the round trips below: silent
    double timeout_round_trips;  ///< as measured
    double max_timeout_s;        ///< it doubles with every move that brought no answer
    double status_timeout_s;     ///< a localizer that is silent about itself for longer is gone
    double exclusion_s;          ///< of a silent localizer; doubles each time
    double max_exclusion_s;
    double overload;         ///< load from which on a robot considers to move
    double min_load_gain;    ///< of such a move
    double load_patience_s;  ///< for that long; robots differ by up to twice
  };
  /// What is known of the way to the chosen localizer and back.
  struct Link {
    std::optional<Duration> round_trip;
    double loss = 0.0;
  };
  enum class Change {
    kNone,
    kChosen,     ///< another localizer than before
    kRestarted,  ///< the same, but it has forgotten everything
    kLeft,       ///< there is none now
  };

  LocalizerSelector(std::string_view robot, const Config& config);

  /// What a localizer says of itself. Returns why it is not believed: "outdated_localizer", an
  /// earlier start of it, or "conflicting_localizer" if that keeps talking.
  std::optional<std::string_view> hear(const LocalizerStatus& status, Timestamp now);

  /// A submap went to the chosen localizer, which is expected to answer.
  void sent(Timestamp now);
  void answered(Timestamp now);

  /// From now on only localizers with this map are used: poses in another one mean nothing.
  void keep_to(const MapHash& map) { map_ = map; }
  [[nodiscard]] bool is_right(const MapHash& map) const { return !map_ || *map_ == map; }

  /// To be called regularly.
  Change decide(Timestamp now, const Link& link);

  [[nodiscard]] const std::string& name() const { return name_; }         ///< empty: none
  [[nodiscard]] Incarnation incarnation() const { return incarnation_; }  ///< of the chosen one
  /// Why the last change happened, in words for a log.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// In words, while the chosen localizer fails and there is no other; else empty.
  [[nodiscard]] const std::string& trouble() const { return trouble_; }
  /// One that would accept the robot if its map were the right one; empty if there is none.
  [[nodiscard]] std::string_view other_map() const { return other_map_; }

 private:
  struct Known {
    LocalizerStatus status;
    Timestamp heard;
    std::optional<Timestamp> older_heard;  // an earlier start of it
    Timestamp excluded_until{Timestamp::min()};
    int consecutive_timeouts =
        0;  // times that it was left because it was silent, since its last answer
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
  Change leave_silent(Known& current, Candidate other, std::string reason, Timestamp now);
  Change leave(std::string reason);
  void forget_stalest();

  std::string robot_;
  Config config_;
  std::map<std::string, Known> known_;
  std::optional<MapHash> map_;
  std::string name_;
  Incarnation incarnation_{};
  bool has_answered_ = false;               // since it was chosen
  std::optional<Timestamp> waiting_since_;  // for an answer
  Timestamp last_sign_;                     // of the chosen: its choice, or its last answer
  std::optional<Timestamp> overloaded_since_;
  int consecutive_timeouts_ = 0;  // moves without an answer since
  std::string reason_;
  std::string trouble_;
  std::string other_map_;
};

LocalizerSelector::Config read_localizer_selector_config(ConfigReader config);

}  // namespace fleetloc
