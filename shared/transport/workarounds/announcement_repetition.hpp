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

/// Says when this participant's announcement is to be repeated: for somebody who has announced
/// himself and does not know it yet, since nothing has come from there that is addressed to it; and
/// for whoever may be there, while nobody knows it. For the former the pauses double, and so do the
/// copies. Both end after some tries: who hears nothing is left to the periodic announcements.
///
/// No clock, no I/O. Any thread may use any function.
class AnnouncementRepetition {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Pause = std::chrono::steady_clock::duration;

  /// An announcement that is due.
  struct Due {
    int copies = 1;
    Pause next{};  ///< until the next one is to be asked for
  };

  /// @param max_copies  of an announcement to one participant, at least one
  explicit AnnouncementRepetition(int max_copies) : max_copies_(max_copies) {}

  /// @param datagram  that has arrived, well-formed RTPS
  /// @param own       of this participant
  /// @return until again() is to be asked about its sender; nothing if it is not new
  std::optional<Pause> heard(RtpsBytes datagram, const GuidPrefix& own, Time now);

  /// Nothing if the participant knows this one by now, or there have been enough tries.
  std::optional<Due> again(const GuidPrefix& participant);

  /// To whoever may be there, from the first announcement on: until the next one is due; much
  /// longer once somebody is heard, to whom more is sent. Nothing once anybody knows this
  /// participant, or after enough tries.
  std::optional<Pause> again_to_all();
  static constexpr std::chrono::seconds kFirstToAll{1};

  /// Whether anybody has shown that it knows this participant.
  [[nodiscard]] bool is_known() const { return is_known_.load(std::memory_order_relaxed); }

 private:
  struct Stranger {
    Time heard{};
    bool knows_us = false;
    int tries = 0;
  };

  bool has_room(Time now);

  const int max_copies_;
  std::atomic<bool> is_known_ = false;
  std::atomic<int> tries_to_all_ = 0;
  std::mutex mutex_;
  std::map<GuidPrefix, Stranger> strangers_;  // guarded by mutex_
  Time made_room_{};                          // guarded by mutex_
};

}  // namespace fleetloc
