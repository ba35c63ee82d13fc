#include "deploy/replay/align_once.hpp"

namespace fleetloc {

std::vector<LocalizationResult> AlignOnce::take_answers(Timestamp now) {
  for (LocalizationResult& answer : LocalizerDecorator::take_answers(now)) {
    if (!aligned_) waiting_.push_back(std::move(answer));
  }
  if (waiting_.empty()) return {};
  std::vector<LocalizationResult> next{std::move(waiting_.front())};
  waiting_.pop_front();
  return next;
}

std::optional<Correction> AlignOnce::take_correction() {
  static_cast<void>(LocalizerDecorator::take_correction());
  return std::nullopt;
}

void AlignOnce::note_applied() {
  aligned_ = true;
  waiting_.clear();
  LocalizerDecorator::note_applied();
}

}  // namespace fleetloc
