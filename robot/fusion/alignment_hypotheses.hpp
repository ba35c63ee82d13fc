#pragma once

#include <optional>
#include <string>
#include <vector>

#include "robot/fusion/localization_measurement.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Number of independent answers that support an alignment: those whose windows do not overlap, or
/// that come from different localizers or incarnations.
class HypothesisSupport {
 public:
  void add(const LocalizationMeasurement& answer);
  [[nodiscard]] int independent() const { return independent_; }
  /// Whether the answer's window contains all windows of the supporting answers, which are older
  /// than it.
  [[nodiscard]] bool is_within_window(const LocalizationMeasurement& answer) const;

 private:
  struct Source {
    std::string localizer;
    Incarnation incarnation{};
    Timestamp counted;  ///< stamp of its last answer that counted
  };
  std::vector<Source> sources_;
  int independent_ = 0;
  std::optional<Timestamp> oldest_stamp_;  ///< where the earliest of their windows begins
};

/// Hypotheses of T_map_odom from answers that the gate rejected and that agree with each other: the
/// filter may be the one that is wrong. A hypothesis replaces the current estimate as soon as it
/// has more independent support, or `restart_after` independent answers; or if it contradicts the
/// estimate by an answer whose window contains all that the estimate rests on. A value: copy it to
/// replay.
class AlignmentHypotheses {
 public:
  struct Config {
    double gate_chi_square = 0.0;  ///< 6 degrees of freedom
    int lost_after = 0;            ///< so many agreeing rejected answers contradict the filter; as
                                   ///< many applied ones in a row end that
    int restart_after = 0;         ///< independent answers that replace the filter's alignment,
                                   ///< whatever its own support
  };
  explicit AlignmentHypotheses(const Config& config);

  /// Adds drift of T_map_odom (right perturbation) to all hypotheses.
  void drift(const Matrix6d& covariance);

  /// The current estimate was initialized from this answer: takes over the support of its
  /// hypothesis, if there is one, and drops all hypotheses.
  void restart(const LocalizationMeasurement& answer);

  /// The localizer no longer believes in the current estimate: nothing supports it any more, and
  /// the next answer decides.
  void lose();

  /// An applied answer supports the current estimate and counts against the hypotheses. Where the
  /// estimate was so uncertain that the answer alone tells where it is, as after seconds without
  /// vision, nothing else supports it any more.
  ///
  /// @param before  covariance of T_map_body at the answer before it was applied
  void support(const LocalizationMeasurement& applied, const Matrix6d& before);

  /// Adds a rejected answer. True if its hypothesis is to replace the current estimate.
  bool add(const LocalizationMeasurement& rejected);

  /// Support of the current estimate without the hypotheses, for after a reset of the odometry.
  [[nodiscard]] AlignmentHypotheses without_alternatives() const;

  /// True if a hypothesis has `lost_after` agreeing answers, and from lose() to the next answer.
  [[nodiscard]] bool contradict() const;

  /// With a covariance that covers the contradicting hypotheses (outer product of the difference);
  /// after lose() with one of anywhere.
  [[nodiscard]] MapOdomEstimate inflated(MapOdomEstimate estimate) const;

 private:
  struct Hypothesis {
    Pose T_map_odom;  ///< from its newest answer alone
    Matrix6d covariance;
    int agreeing = 0;
    int applied_since = 0;  ///< answers applied in a row since it was supported
    HypothesisSupport support;
  };
  [[nodiscard]] bool agrees(const Hypothesis& hypothesis,
                            const LocalizationMeasurement& answer) const;
  [[nodiscard]] bool contradicts(const Hypothesis& hypothesis) const;

  Config config_;
  HypothesisSupport current_support_;
  bool is_lost_ = false;
  std::vector<Hypothesis> hypotheses_;  ///< the one supported last is last
};

}  // namespace fleetloc
