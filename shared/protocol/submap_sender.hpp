#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "shared/model/answer.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// The robot's end of the submap stream towards one localizer: numbers what is sent, and learns
/// from the acknowledgements what arrived and how long that took. A new epoch (the localizer was
/// restarted, or is another one) voids all acknowledgements.
class SubmapSender {
 public:
  /// Fills in what identifies the sample. `keyframe` of the newest item times the round trip.
  void prepare(Submap& submap, Timestamp now);

  /// Takes the acknowledgements of an answer; those of another epoch than the current one start
  /// the counting anew, those of an older epoch are ignored.
  void acknowledge(const Answer& answer, Timestamp now);

  /// A new session: numbers start at zero again.
  void restart(SessionNumber session);

  /// From a submap's sending to the first answer that localizes its newest keyframe.
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
  Epoch epoch_{};
  std::uint32_t next_number_ = 0;
  std::uint32_t acknowledged_base_ = 0;
  std::uint64_t acknowledged_bitmap_ = 0;
  std::map<std::uint32_t, Sent> in_flight_;  // by sample number
  std::optional<Duration> round_trip_;
};

}  // namespace fleetloc
