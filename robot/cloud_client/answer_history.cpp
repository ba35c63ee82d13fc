#include "robot/cloud_client/answer_history.hpp"

#include <algorithm>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxLatest = 64;  // some ten seconds: repetitions may be late

// Between the oldest and the newest keyframe that the answer's pose rests on.
double window_s(const LocalizationResult& answer) {
  const bool has_pose = answer.status == LocalizationStatus::kLocalized;
  return has_pose ? to_seconds(answer.stamp - answer.oldest_stamp) : 0.0;
}

}  // namespace

void AnswerHistory::start_session() {
  latest_.clear();
  window_s_ = 0.0;
  localized_.reset();
  correction_.reset();
  corrected_anchor_.reset();
}

bool AnswerHistory::add(const LocalizationResult& answer, Timestamp now) {
  Identity identity(
      answer.localizer, answer.incarnation, answer.keyframe, answer.revision, answer.status);
  if (std::ranges::find(latest_, identity) != latest_.end()) return false;
  latest_.push_back(std::move(identity));
  if (latest_.size() > kMaxLatest) latest_.pop_front();
  if (answer.status == LocalizationStatus::kLocalized) {
    map_ = answer.map_hash;
    localized_ = now;
  }
  window_s_ = window_s(answer);
  return true;
}

void AnswerHistory::add(Correction correction) {
  if (corrected_anchor_ && correction.anchor <= *corrected_anchor_) return;
  corrected_anchor_ = correction.anchor;
  correction_ = std::move(correction);
}

std::optional<Correction> AnswerHistory::take_correction() {
  return std::exchange(correction_, std::nullopt);
}

// The first keyframes that a successor gets may be too few to go on with.
bool AnswerHistory::is_matched_by(const LocalizationResult& answer,
                                  const LocalizerSelector::Successor& successor,
                                  Timestamp now) const {
  constexpr double kLongSeconds = 10.0;
  constexpr double kPatienceSeconds = 4.0;  // under loss not all keyframes arrive
  constexpr double kShareOfWindow = 0.8;
  if (successor.is_urgent || !localized_ || to_seconds(now - *localized_) > kLongSeconds) {
    return true;
  }
  if (answer.status != LocalizationStatus::kLocalized) return false;
  if (to_seconds(now - successor.since) > kPatienceSeconds) return true;
  return window_s(answer) >= kShareOfWindow * window_s_;
}

}  // namespace fleetloc
