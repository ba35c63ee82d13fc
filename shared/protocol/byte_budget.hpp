#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

#include "shared/core/time.hpp"
#include "shared/protocol/token_bucket.hpp"

namespace fleetloc {

class ConfigReader;

/// How many bytes one end may send: a token bucket, whose rate follows the queueing delay of the
/// link. While round trips are about as short as the shortest, the rate grows by constant steps;
/// when they get longer, it is cut to a share of what the link has passed lately, which shares a
/// bottleneck evenly among robots that know nothing of each other (Chiu and Jain, 1989; delay as
/// the signal: LEDBAT, RFC 6817). Loss is no sign of congestion here: radio links lose at any rate.
/// Silence may be one: until a round trip is measured, and after a time without any, the rate is
/// low enough to leave room for discovery on the narrowest link.
class ByteBudget {
 public:
  struct Config {
    double max_bytes_per_s;            ///< on the wire
    double max_bytes_per_s_high_loss;  ///< the same, from `high_loss` on
    double high_loss;                  ///< share of samples
    double min_bytes_per_s;
    double burst_bytes;             ///< that may be sent at once after a pause
    double max_queueing_s;          ///< beyond it the rate is cut
    double increase_bytes_per_s2;   ///< otherwise it grows
    double decrease;                ///< share of the passed rate that is left by a cut
    double shortest_memory_s;       ///< for so long the shortest round trip is remembered
    double unmeasured_bytes_per_s;  ///< at most, while no round trip is known
    double measured_for_s;          ///< after the latest round trip
  };

  explicit ByteBudget(const Config& config);

  /// To be called before the others, with the link's loss.
  void advance(Timestamp now, double loss);

  /// There and back, without the time spent at the other end.
  void measured(Duration round_trip, Timestamp now);

  [[nodiscard]] bool allows(std::size_t bytes) const { return tokens_.allows(bytes); }
  void spend(std::size_t bytes) { tokens_.spend(bytes); }

  /// Bytes on top, once; none while no round trip is known.
  void grant(std::size_t bytes) {
    if (is_measured()) tokens_.grant(bytes);
  }
  /// Whether some of these are left.
  [[nodiscard]] bool has_grant() const { return tokens_.exceeds_burst(); }

  [[nodiscard]] double bytes_per_s() const {
    return is_measured() ? rate_ : std::min(rate_, config_.unmeasured_bytes_per_s);
  }
  [[nodiscard]] Duration queueing() const { return queueing_; }
  /// The latest one, past jitter; zero before the first.
  [[nodiscard]] Duration round_trip() const { return round_trip_; }

 private:
  struct RoundTrip {
    Timestamp at;
    Duration length{};
  };

  [[nodiscard]] double stretch() const;
  [[nodiscard]] bool is_measured() const {
    return !recent_.empty() && to_seconds(*now_ - recent_.back().at) <= config_.measured_for_s;
  }

  Config config_;
  double cap_;
  double rate_;
  TokenBucket tokens_;
  std::optional<Timestamp> now_;
  std::deque<RoundTrip> recent_;    // to look past jitter
  std::deque<RoundTrip> shortest_;  // increasing in both
  Duration queueing_{};
  Duration round_trip_{};
  std::optional<Timestamp> next_cut_;
};

ByteBudget::Config read_byte_budget_config(ConfigReader config);

}  // namespace fleetloc
