#pragma once

#include <string>
#include <vector>

#include "robot/cloud_client/localizer_selector.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// What a log is told of a robot's localizers, a line for each event. What lasts is told once.
class LocalizerEvents {
 public:
  void start_session(Timestamp now) { session_started_ = now; }

  void chosen(const LocalizerSelector& selector);
  void left(const std::string& localizer, const LocalizerSelector& selector);
  void stays(const std::string& localizer);
  void to_take_over(const LocalizerSelector::Successor& successor);
  /// Nothing has changed; it may fail, or another one be refused for its map.
  void unchanged(const LocalizerSelector& selector);
  /// Two localizers have this name.
  void conflict(const std::string& localizer);
  /// Another program speaks for this localizer.
  void foreign_writer(const std::string& localizer);
  /// An answer to this robot, and to a session that it does not have.
  void foreign_answer(Timestamp now);

  /// Those since the last call.
  [[nodiscard]] std::vector<std::string> take();

 private:
  void note(std::string event);
  void note_other_map(const LocalizerSelector& selector);
  void note_warning(const LocalizerSelector& selector);

  std::vector<std::string> events_;
  std::string other_map_;  // the localizer that was last told to have another map
  std::string warning_;    // that was told last
  bool has_conflict_ = false;
  Timestamp session_started_{};
  int foreign_answers_ = 0;  // late ones
};

}  // namespace fleetloc
