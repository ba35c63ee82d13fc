#pragma once

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "robot/cloud_client/localizer_selector.hpp"
#include "shared/config/config_reader.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
inline LocalizerSelector::Config config() {
  LocalizerSelector::Config config = read_localizer_selector_config(
      ConfigReader::from_string(default_config("robot")).section("client").section("selector"));
  config.known.status_timeout_s =
      6.0;  // of localizers that tell their status as often as those here
  return config;
}

/// A robot's selector among localizers that live, answer and are loaded as a test says.
class LocalizerSelectorTest : public testing::Test {
 protected:
  using Change = LocalizerSelector::Change;
  struct Localizer {
    std::uint32_t incarnation = 1;
    double load = 0.0;
    std::uint8_t map = 1;
    bool accepting = true;
    bool answers = true;
    bool lives = true;
    bool draining = false;
    int sessions = 0;
  };

  /// Status, submaps and answers, as they come.
  void play(double until_s) {
    for (; now_s_ < until_s; now_s_ += 0.1) {
      const Timestamp now = at(now_s_);
      for (const auto& [name, localizer] : localizers_) {
        if (localizer.lives) selector_.update(status(name, localizer), now);
      }
      const Change change = selector_.decide(now, {.round_trip = std::chrono::milliseconds(200)});
      if (change != Change::kNone) changes_.push_back(change);
      if (selector_.name().empty()) continue;
      selector_.sent(now);
      const Localizer& chosen = localizers_.at(selector_.name());
      if (chosen.lives && chosen.answers &&
          chosen.incarnation == static_cast<std::uint32_t>(selector_.incarnation())) {
        selector_.answered(now);
      }
      answer_as_successor(now);
    }
  }

  void answer_as_successor(Timestamp now) {
    if (!selector_.successor()) return;
    const Localizer& next = localizers_.at(selector_.successor()->name);
    if (!next.lives || !next.answers) return;
    selector_.take_over(now);
    selector_.answered(now);
    changes_.push_back(Change::kChosen);
  }

  static LocalizerStatus status(const std::string& name, const Localizer& localizer) {
    return {.localizer = name,
            .incarnation = Incarnation{localizer.incarnation},
            .map_hash = {localizer.map},
            .sessions = localizer.sessions,
            .load = localizer.load,
            .accepting = localizer.accepting && !localizer.draining,
            .draining = localizer.draining};
  }

  double now_s_ = 0.0;
  std::map<std::string, Localizer> localizers_;
  LocalizerSelector selector_{"robot", config()};
  std::vector<Change> changes_;
};

}  // namespace fleetloc
