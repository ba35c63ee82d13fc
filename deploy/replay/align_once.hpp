#pragma once

#include <deque>

#include "deploy/replay/localizer_decorator.hpp"

namespace fleetloc {

/// A control experiment: the robot is aligned by the first answer that it applies. It gets no other
/// one after that, and no correction at all.
class AlignOnce final : public LocalizerDecorator {
 public:
  using LocalizerDecorator::LocalizerDecorator;

  /// At most one at a time, since it may be the one.
  [[nodiscard]] std::vector<LocalizationResult> take_answers(Timestamp now) override;
  [[nodiscard]] std::optional<Correction> take_correction() override;
  void note_applied() override;

 private:
  std::deque<LocalizationResult> waiting_;
  bool aligned_ = false;
};

}  // namespace fleetloc
