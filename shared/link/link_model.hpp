#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "shared/core/counter_random.hpp"
#include "shared/core/time.hpp"
#include "shared/link/bottleneck.hpp"
#include "shared/link/burst_loss.hpp"
#include "shared/link/link_config.hpp"
#include "shared/link/random_delay.hpp"

namespace fleetloc {

/// Decides for each datagram of one direction whether, when and how often it arrives;
/// deterministic by seed and calls. The stages in their order: finite queue and rate limit
/// (Bottleneck), outages, loss (BurstLoss), delay (RandomDelay), duplication. So a lost datagram
/// has used the bottleneck, one that the queue drops has not, and a copy has not either.
///
/// What is drawn for a datagram depends on the seed and its number only: at one seed, settings that
/// differ elsewhere lose and delay the same datagrams.
class LinkModel {
 public:
  LinkModel(const LinkDirection& direction, std::uint64_t seed);

  /// Begins the time of trace and outages. The first call counts, the first datagram is one.
  void start(Timestamp now);

  /// When a datagram that is sent at `now` arrives, in no order: once for each of its copies, never
  /// if it is lost.
  /// @param now  one before that of an earlier call counts as that one
  std::vector<Timestamp> arrivals(Timestamp now, std::size_t wire_bytes);

 private:
  Bottleneck bottleneck_;
  Outages outages_;
  BurstLoss loss_;
  RandomDelay delay_;
  double duplication_;
  CounterRandom duplication_random_;
  std::uint64_t datagrams_ = 0;
  std::optional<Timestamp> start_;
  Duration elapsed_{};  // since the start, at the last datagram
};

}  // namespace fleetloc
