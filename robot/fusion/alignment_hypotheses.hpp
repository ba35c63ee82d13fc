#pragma once

#include <string>
#include <vector>

#include "robot/fusion/localization_measurement.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// How many answers speak for something. They are independent if their windows do not overlap, or
/// if another start of a localizer made them.
class HypothesisSupport {
 public:
  /// @param window_s  length of the cloud's window
  void add(const LocalizationMeasurement& answer, double window_s);
  [[nodiscard]] int independent() const { return independent_; }

 private:
  struct Source {
    std::string localizer;
    Incarnation incarnation{};
    Timestamp counted;  ///< stamp of its last answer that counted
  };
  std::vector<Source> sources_;
  int independent_ = 0;
};

/// What rejected answers say that agree with each other: if a gate rejects them all, the mistake
/// may be the filter's. An alignment replaces the one that is held as soon as more independent
/// answers speak for it, or enough of them. A value, for replay.
class AlignmentHypotheses {
 public:
  struct Config {
    double gate_chi_square = 0.0;  ///< 6 degrees of freedom
    double window_s = 0.0;         ///< length of the cloud's window
    int lost_after = 0;            ///< agreeing rejected answers contradict the filter; so many
                                   ///< applied ones in a row end that
    int restart_after = 0;         ///< independent answers that replace the filter's alignment,
                                   ///< however many it rests on
  };
  explicit AlignmentHypotheses(const Config& config);

  /// T_map_odom has become that much more uncertain.
  void drift(const Matrix6d& covariance);

  /// What is held rests on this answer now; or, if it had been rejected, on those that agreed.
  void restart(const LocalizationMeasurement& answer);

  /// Takes an applied answer.
  void support(const LocalizationMeasurement& applied);

  /// Takes a rejected answer. True: what it says is to replace what is held.
  bool add(const LocalizationMeasurement& rejected);

  /// For a held alignment that goes on in another odometry: it rests on what it did.
  [[nodiscard]] AlignmentHypotheses without_alternatives() const;

  [[nodiscard]] bool contradict() const;

  /// With a covariance that reaches to the alignments that contradict it.
  [[nodiscard]] MapOdomEstimate hedged(MapOdomEstimate held) const;

 private:
  struct Hypothesis {
    Pose T_map_odom;  ///< by its newest answer alone
    Matrix6d covariance;
    int agreeing = 0;
    int applied_since = 0;  ///< answers that spoke against it in a row
    HypothesisSupport support;
  };
  [[nodiscard]] bool agrees(const Hypothesis& hypothesis,
                            const LocalizationMeasurement& answer) const;
  [[nodiscard]] bool contradicts(const Hypothesis& hypothesis) const;

  Config config_;
  HypothesisSupport held_;
  std::vector<Hypothesis> hypotheses_;  ///< the one agreed with last is last
};

}  // namespace fleetloc
