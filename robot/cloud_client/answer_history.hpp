#pragma once

#include <deque>
#include <optional>
#include <string>
#include <tuple>

#include "robot/cloud_client/localizer_selector.hpp"
#include "shared/core/time.hpp"
#include "shared/model/correction.hpp"
#include "shared/model/localization_result.hpp"

namespace fleetloc {

/// The answers of a session so far: which ones are new, what they correct, and from what window on
/// a successor answers as well as the localizer does.
class AnswerHistory {
 public:
  /// Answers and corrections are of a new session from now on.
  void start_session();

  /// @return whether it is new: a repetition may be late, behind newer answers
  bool add(const LocalizationResult& answer, Timestamp now);

  /// The newest one counts; a repeated or late answer brings none.
  void add(Correction correction);
  /// Not yet taken.
  [[nodiscard]] std::optional<Correction> take_correction();

  /// Whether with this answer of the successor nothing gets worse: it has a pose from about as long
  /// a window as the latest answer here, or the answers here are silent or without a pose for long.
  [[nodiscard]] bool is_matched_by(const LocalizationResult& answer,
                                   const LocalizerSelector::Successor& successor,
                                   Timestamp now) const;

  /// Of the newest answer with a pose, of this session or one before.
  [[nodiscard]] const std::optional<MapHash>& map() const { return map_; }

 private:
  /// Answers with an equal one are repetitions.
  using Identity = std::tuple<std::string, Incarnation, KeyframeId, Revision, LocalizationStatus>;

  std::deque<Identity> latest_;
  double window_s_ = 0.0;               // that the latest answer rests on
  std::optional<Timestamp> localized_;  // arrival of the latest answer with a pose
  std::optional<MapHash> map_;
  std::optional<Correction> correction_;
  std::optional<KeyframeId> corrected_anchor_;  // of the newest correction
};

}  // namespace fleetloc
