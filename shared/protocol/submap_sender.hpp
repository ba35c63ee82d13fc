#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "shared/model/localization_result.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// The robot's end of the submap stream towards one incarnation of one localizer: numbers the
/// samples, and measures loss and round trip from the acknowledgements, which are valid within one
/// session and incarnation.
class SubmapSender {
 public:
  /// Sets session, incarnation and number. The newest keyframe identifies the submap's answers.
  void prepare(Submap& submap, Timestamp now);

  /// Takes the acknowledgements of an answer; those of another session or incarnation are ignored.
  /// @return the time on the network there and back, of the newest acknowledged sample and this
  ///         answer: the time from the one to the other less that in the cloud, as QUIC has it (RFC
  ///         9002, 5.3)
  std::optional<Duration> acknowledge(const LocalizationResult& answer, Timestamp now);

  /// A new session, incarnation or localizer: all acknowledgements are discarded. Numbers start at
  /// zero with each session.
  /// @param used  numbers of the same session below it are not used again: another sender has
  void restart(SessionNumber session, Incarnation incarnation, std::uint32_t used = 0);

  /// True if a submap with this newest keyframe was sent and may still be on its way.
  [[nodiscard]] bool awaits(KeyframeId newest) const;

  /// From sending a submap to the first answer that acknowledges it; the latest measured.
  [[nodiscard]] std::optional<Duration> round_trip() const { return round_trip_; }

  /// Share of the latest samples, up to 64, that should be acknowledged by now and are not.
  [[nodiscard]] double loss() const;

  /// The same as an expectation. Samples that were sent after the last acknowledged one count as
  /// lost once an acknowledgement is overdue; where few samples are known, it is between that and a
  /// link of which nothing is known.
  [[nodiscard]] double expected_loss(Timestamp now) const;

  /// Whether the answer's acknowledgements are of this session and incarnation, and of samples that
  /// were sent: a wrong number far ahead would make all that follow look old.
  [[nodiscard]] bool is_of_stream(const LocalizationResult& answer) const {
    return answer.session == session_ && answer.incarnation == incarnation_ &&
           is_of_sent(answer.acknowledgements);
  }

  [[nodiscard]] std::uint32_t sent() const { return next_number_; }

 private:
  struct Sent {
    Timestamp at;
    KeyframeId newest{};
    bool is_acknowledged = false;
  };

  [[nodiscard]] bool is_of_sent(const Acknowledgements& acknowledgements) const;

  SessionNumber session_{};
  Incarnation incarnation_{};
  std::uint32_t next_number_ = 0;
  std::uint32_t acknowledged_base_ = 0;
  std::uint64_t acknowledged_bitmap_ = 0;
  std::map<std::uint32_t, Sent> in_flight_;  // by sample number, from the newest acknowledged on
  std::optional<Duration> round_trip_;
};

}  // namespace fleetloc
