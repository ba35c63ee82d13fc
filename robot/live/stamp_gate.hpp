#pragma once

#include <optional>
#include <string_view>

#include "shared/core/arrival_time.hpp"
#include "shared/core/expected.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// Why a stamp is refused.
enum class StampRefusal {
  kZero,         ///< or negative: nobody has set it
  kDoubled,      ///< that of the measurement before
  kOutOfOrder,   ///< older than it, by less than a clock is set
  kUnconfirmed,  ///< far from where it should be, and the next ones have to confirm it
};

/// Name in counts, e.g. "out_of_order".
std::string_view name(StampRefusal reason);

/// A stamp that is later than the one before, or the first after the clock was set.
struct AcceptedStamp {
  std::optional<Duration> step;  ///< the clock was set by this much
  Duration unseen{};             ///< since the arrival of the one accepted before
};

/// The stamps of one sensor: tells doubled and late ones from a clock that was set. A stamp that
/// differs by more than 1 s from what the arrival times tell must be followed by two that go on
/// from it; so a single wrong one does no harm, and neither a stop of the sensor nor a delay of
/// its messages is taken for a step. Sensors are faster than 1 Hz.
class StampGate {
 public:
  expected<AcceptedStamp, StampRefusal> check(Timestamp stamp, ArrivalTime arrival);

  /// The next stamp is accepted, whatever it is.
  void forget();

 private:
  struct Candidate {
    Timestamp newest;
    int count = 0;
  };

  [[nodiscard]] bool confirms(Timestamp stamp);

  std::optional<Timestamp> newest_;
  ArrivalTime arrival_;  // of the newest
  std::optional<Candidate> candidate_;
};

}  // namespace fleetloc
