#pragma once

#include <cstdint>

#include "shared/core/counter_random.hpp"

namespace fleetloc {

/// Which datagrams are lost: the two-state Markov chain of Gilbert (1960) and Elliott (1963), whose
/// good state loses nothing and whose bad one everything. Each datagram shares the fate of the one
/// before it with probability 1 - 1 / burst_length, and else draws one of its own.
///
/// So the mean loss is `loss`, a drawn fate holds for `burst_length` datagrams in the mean, and the
/// mean number lost in a row is burst_length / (1 - loss): at length 1, losses are independent. In
/// the words of Gilbert, P(good to bad) = loss / burst_length, P(bad to good) = (1 - loss) /
/// burst_length. At one seed and burst length, what is lost at a low loss is lost at a higher one.
class BurstLoss {
 public:
  /// @param loss          share of the datagrams, 0..1
  /// @param burst_length  at least 1
  BurstLoss(double loss, double burst_length, std::uint64_t seed);

  /// Whether the next datagram is lost.
  bool next();

 private:
  double loss_;
  double redrawing_;  // probability
  CounterRandom random_;
  std::uint64_t datagrams_ = 0;
  double fate_ = 0.0;  // in (0, 1), of the last datagram; below the loss: lost
};

}  // namespace fleetloc
