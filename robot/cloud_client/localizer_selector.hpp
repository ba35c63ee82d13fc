#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robot/cloud_client/known_localizers.hpp"
#include "shared/core/expected.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

class ConfigReader;

/// Selects the localizer of a robot from LocalizerStatus and from the answers that arrive; which
/// one of several KnownLocalizers tells.
///
/// A robot makes before it breaks: when its localizer is about to end, does not answer or has too
/// much to do, it keeps it and begins with a successor beside it. Whichever answers first goes on:
/// the successor takes over with its first answer; one that was only silent for a while stays. The
/// one that was left for its silence is excluded for a time that doubles with each timeout, unless
/// there is no other.
///
/// Load balancing: the robot leaves an overloaded localizer only for one with clearly less load,
/// and a crowded one for one with clearly fewer robots, each robot after a delay of its own, so
/// that they see one another's moves. Deterministic, no clock.
class LocalizerSelector {
 public:
  struct Config {
    double answer_timeout_s;     ///< without an answer, on top of the round trips below
    double timeout_round_trips;  ///< of the measured length
    double first_round_trip_s;   ///< assumed until one is measured
    double sample_interval_s;    ///< so often an answer is asked for
    double max_timeout_s;        ///< doubles with every change without an answer since
    double overload;             ///< load from which on a robot may switch
    double min_load_gain;        ///< smallest difference of loads for a switch
    double load_patience_s;      ///< how long it must last; up to twice, by robot
    double crowd_patience_s;     ///< the same, for too many robots; up to thrice
    KnownLocalizers::Config known;
  };
  /// Measured properties of the link to the chosen localizer.
  struct Link {
    std::optional<Duration> round_trip;
    double loss = 0.0;  ///< share of samples, 0..1
  };
  enum class Change {
    kNone,
    kChosen,     ///< another localizer than before; if it was the successor, that has taken over
    kRestarted,  ///< the same one, which has lost all sessions
    kLeft,       ///< there is none now
    kSuccessor,  ///< the chosen one stays until this one, which is new, answers
    kStays,      ///< the chosen one, and there is no successor any more
  };
  struct Successor {
    std::string name;
    Incarnation incarnation{};
    Timestamp since;
    std::string reason;                 ///< for the change
    bool is_urgent = false;             ///< the chosen one is silent
    std::optional<Timestamp> answered;  ///< without a pose
  };

  LocalizerSelector(std::string_view robot, const Config& config);

  expected<void, StatusRefusal> update(const LocalizerStatus& status, Timestamp now) {
    const std::string_view next = successor_ ? std::string_view(successor_->name) : "";
    return known_.update(status, {name_, next}, now);
  }

  /// A submap was sent to the chosen localizer: an answer is expected.
  void sent(Timestamp now);
  /// By the chosen localizer.
  void answered(Timestamp now);
  /// By the successor, with a pose: it becomes the chosen one.
  void take_over(Timestamp now);
  /// By the successor, without a pose.
  void successor_answered(Timestamp now) { successor_->answered = now; }
  void drop_successor() { successor_.reset(); }

  /// From now on only localizers with this map are used: the robot's map poses refer to it.
  void require_map(const MapHash& map) { known_.require_map(map); }
  [[nodiscard]] bool accepts_map(const MapHash& map) const { return known_.accepts_map(map); }

  /// Evaluates timeouts and loads; to be called regularly.
  Change decide(Timestamp now, const Link& link);

  /// The others that it would choose next, the best one first.
  [[nodiscard]] std::vector<std::string> standbys(std::size_t count, Timestamp now) const {
    return known_.standbys(count, name_, now);
  }

  [[nodiscard]] const std::string& name() const { return name_; }         ///< empty: none
  [[nodiscard]] Incarnation incarnation() const { return incarnation_; }  ///< of the chosen one
  [[nodiscard]] const std::optional<Successor>& successor() const { return successor_; }
  /// Why the last change happened, as text for a log.
  [[nodiscard]] const std::string& reason() const { return reason_; }
  /// Text for a log while the chosen localizer fails and there is no other; else empty.
  [[nodiscard]] const std::string& warning() const { return warning_; }
  /// A localizer that accepts robots but has another map; empty if there is none.
  [[nodiscard]] const std::string& other_map() const { return other_map_; }

 private:
  using Localizer = KnownLocalizers::Localizer;
  using Range = KnownLocalizers::Range;
  enum class Fault { kNone, kDraining, kGone, kSilent, kRefuses };

  [[nodiscard]] Fault fault_of(const Localizer& current, Timestamp now, const Link& link) const;
  [[nodiscard]] bool is_late(Timestamp since, Timestamp now, const Link& link, double factor) const;
  [[nodiscard]] bool is_crowded_for_long(const Localizer& current,
                                         const Localizer& other,
                                         Timestamp now);
  [[nodiscard]] bool is_overloaded_for_long(const Localizer& current,
                                            const Localizer& other,
                                            Timestamp now);
  [[nodiscard]] double patience(std::string_view of) const;
  Change choose_first(Timestamp now);
  Change leave_map(Timestamp now);
  Change follow_restart(const Localizer& current, Timestamp now);
  Change follow_successor(Timestamp now, const Link& link);
  Change replace_successor(Fault fault, bool is_lost, Timestamp now);
  Change leave(Fault fault, Timestamp now);
  Change balance(const Localizer& current, Timestamp now);
  Change begin(const Localizer& successor, std::string reason, bool is_urgent, Timestamp now);
  Change stay();
  void choose(const std::string& name, Incarnation incarnation, std::string reason, Timestamp now);

  std::string robot_;
  Config config_;
  KnownLocalizers known_;
  std::string name_;
  Incarnation incarnation_{};
  std::optional<Successor> successor_;
  bool has_answered_ = false;               // since it was chosen
  std::optional<Timestamp> waiting_since_;  // for an answer
  Timestamp last_activity_;                 // when it was chosen, or its last answer
  std::optional<Timestamp> overloaded_since_;
  std::optional<Timestamp> crowded_since_;
  std::uint32_t moves_ = 0;       // begun for the sake of load
  int consecutive_timeouts_ = 0;  // successors that did not answer, since an answer
  std::string reason_;
  std::string warning_;
  std::string other_map_;
};

LocalizerSelector::Config read_localizer_selector_config(ConfigReader config);

}  // namespace fleetloc
