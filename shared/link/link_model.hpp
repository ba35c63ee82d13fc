#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>

#include "shared/config/config_reader.hpp"
#include "shared/core/time.hpp"

namespace fleetloc {

/// One direction of a link.
struct LinkDirection {
  double loss{};              ///< probability per datagram, independent
  double delay_s{};           ///< one way
  double rate_bytes_per_s{};  ///< 0: unlimited
  std::size_t queue_bytes{};  ///< before the rate limit; what does not fit is dropped
};

/// The link of one robot, seen from it.
struct LinkConfig {
  LinkDirection uplink{}, downlink{};
  std::uint64_t seed{};
};

/// Reads `seed`, and `uplink` and `downlink` with `loss` (0..1), `delay_s` (0..3600),
/// `rate_bytes_per_s` (0: unlimited, else >= 1) and `queue_bytes` (with a rate at least 1500, so
/// that a datagram fits). Anything missing, unknown or out of range is a ConfigError.
LinkConfig read_link_config(ConfigReader config);

/// No loss, no delay, no limit.
LinkConfig perfect_link();

/// Decides for each datagram of one direction whether and when it arrives; deterministic by seed
/// and calls. Order of the stages: finite queue, rate limit, loss, delay; a lost datagram has used
/// the bottleneck, one that the queue drops has not.
class LinkModel {
 public:
  LinkModel(const LinkDirection& direction, std::uint64_t seed);

  /// When a datagram that is sent at `now` arrives; nothing if it never does.
  /// @param now  not before that of the last call; an earlier one counts as that one
  std::optional<Timestamp> arrival(Timestamp now, std::size_t wire_bytes);

 private:
  LinkDirection direction_;
  std::mt19937_64 random_;
  Timestamp bottleneck_free_{Timestamp::min()};  // when all that is queued has been sent
};

}  // namespace fleetloc
