#include "shared/link/burst_loss.hpp"

#include "shared/link/random_streams.hpp"

namespace fleetloc {

BurstLoss::BurstLoss(double loss, double burst_length, std::uint64_t seed)
    : loss_(loss), redrawing_(1.0 / burst_length), random_(seed, kLossStream) {}

bool BurstLoss::next() {
  const bool is_first = datagrams_ == 0;
  const std::uint64_t datagram = datagrams_++;
  if (is_first || random_.uniform(datagram, 1) < redrawing_) fate_ = random_.uniform(datagram, 0);
  return fate_ < loss_;
}

}  // namespace fleetloc
