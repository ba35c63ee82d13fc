#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "shared/model/localization_result.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// The robot's end of the submap stream towards one start of one localizer: numbers what is sent,
/// and learns from the acknowledgements what arrived and how long that took. They count within one
/// session and incarnation.
class SubmapSender {
 public:
  /// Fills in what identifies the sample. `keyframe` of the newest item times the round trip.
  void prepare(Submap& submap, Timestamp now);

  /// Takes the acknowledgements of an answer; those of another session or incarnation are ignored.
  void acknowledge(const LocalizationResult& answer, Timestamp now);

  /// A new session, or another start of a localizer, or another localizer: all acknowledgements are
  /// void. Numbers start at zero with each session.
  void restart(SessionNumber session, Incarnation incarnation);

  /// True if a submap with this newest keyframe was sent and has not been answered yet.
  [[nodiscard]] bool awaits(KeyframeId newest) const;

  /// From a submap's sending to the first answer for its newest keyframe; the latest there was.
  [[nodiscard]] std::optional<Duration> round_trip() const { return round_trip_; }

  /// Share of the latest samples, up to 64, that should be acknowledged by now and are not.
  [[nodiscard]] double loss() const;

  [[nodiscard]] std::uint32_t sent() const { return next_number_; }

 private:
  struct Sent {
    Timestamp at;
    KeyframeId newest{};
  };

  SessionNumber session_{};
  Incarnation incarnation_{};
  std::uint32_t next_number_ = 0;
  std::uint32_t acknowledged_base_ = 0;
  std::uint64_t acknowledged_bitmap_ = 0;
  std::map<std::uint32_t, Sent> in_flight_;  // by sample number
  std::optional<Duration> round_trip_;
};

}  // namespace fleetloc
