#pragma once

// Works around: Fast DDS 2.9.1 answers the announcement of a new participant with its own, once. If
// that is lost, the other side learns of it from the next periodic one, 10 to 60 s later.
// Delete when: it is repeated until the other side answers.

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <optional>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Says when this participant's announcement is to be repeated for somebody who has announced
/// itself and does not know it yet: nothing has come from there that is addressed to it. The pauses
/// double, and end after some tries: who hears nothing is left to the periodic announcements.
///
/// No clock, no I/O. Any thread may use any function.
class AnnouncementRepetition {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Pause = std::chrono::steady_clock::duration;

  /// @param datagram  that has arrived, well-formed RTPS
  /// @param own       of this participant
  /// @return until again() is to be asked about its sender; nothing if it is not new
  std::optional<Pause> heard(RtpsBytes datagram, const GuidPrefix& own, Time now);

  /// Nothing if the participant knows this one by now, or there have been enough tries. Otherwise
  /// the announcement is due, and this is the pause until again() is to be asked again.
  std::optional<Pause> again(const GuidPrefix& participant);

  /// Whether anybody has shown that it knows this participant.
  [[nodiscard]] bool is_known() const { return is_known_.load(std::memory_order_relaxed); }

 private:
  struct Stranger {
    Time heard{};
    bool knows_us = false;
    int tries = 0;
  };

  std::atomic<bool> is_known_ = false;
  std::mutex mutex_;
  std::map<GuidPrefix, Stranger> strangers_;  // guarded by mutex_
};

}  // namespace fleetloc
