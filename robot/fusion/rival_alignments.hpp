#pragma once

#include <string>
#include <vector>

#include "robot/fusion/answer_measurement.hpp"

namespace fleetloc {

/// What rejected answers say that agree with each other: if a gate rejects them all, the mistake
/// may be the filter's. An alignment is trusted once enough of its answers are independent: their
/// windows do not overlap, or another start of a localizer made them. A value, for replay.
class RivalAlignments {
 public:
  struct Config {
    double gate_chi_square = 0.0;  ///< 6 degrees of freedom
    double window_s = 0.0;         ///< length of the cloud's window
    int lost_after = 0;            ///< agreeing rejected answers that contradict the filter
    int restart_after = 0;         ///< independent ones among them that replace it
  };
  explicit RivalAlignments(const Config& config);

  /// T_map_odom has become that much more uncertain.
  void drift(const Matrix6d& covariance);

  /// Takes a rejected answer. True: what it says has been said often enough to be believed.
  bool add(const AnswerMeasurement& rejected);

  [[nodiscard]] bool contradict() const;
  void clear();

 private:
  struct Source {
    std::string localizer;
    Epoch epoch{};
    Timestamp counted;  ///< stamp of its last answer that counted
  };
  struct Rival {
    Pose T_map_odom;  ///< by its newest answer alone
    Matrix6d covariance;
    int agreeing = 0;
    int independent = 0;
    std::vector<Source> sources;
  };
  [[nodiscard]] bool agrees(const Rival& rival, const AnswerMeasurement& answer) const;
  [[nodiscard]] bool is_independent(Rival& rival, const AnswerMeasurement& answer) const;

  Config config_;
  std::vector<Rival> rivals_;  ///< the one agreed with last is last
};

}  // namespace fleetloc
