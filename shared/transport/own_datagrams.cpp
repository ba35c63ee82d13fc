#include "shared/transport/own_datagrams.hpp"

namespace fleetloc {

void OwnDatagrams::sent(RtpsBytes datagram) {
  if (is_known_.load(std::memory_order_relaxed) || datagram.size() < kRtpsHeaderBytes) return;
  std::call_once(learned_, [&] {
    prefix_ = sender_of(datagram);
    is_known_.store(true, std::memory_order_release);
  });
}

bool OwnDatagrams::includes(RtpsBytes datagram) const {
  return is_known_.load(std::memory_order_acquire) && datagram.size() >= kRtpsHeaderBytes &&
         sender_of(datagram) == prefix_;
}

}  // namespace fleetloc
