#include "shared/transport/own_datagrams.hpp"

#include <algorithm>
#include <cstddef>

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

bool OwnDatagrams::are_of_same_process(RtpsBytes datagram) const {
  constexpr std::size_t kProcessBytes = 8;  // vendor, host, process; then the participant
  if (!is_known_.load(std::memory_order_acquire) || datagram.size() < kRtpsHeaderBytes)
    return false;
  const GuidPrefix sender = sender_of(datagram);
  return std::equal(sender.begin(), sender.begin() + kProcessBytes, prefix_.begin());
}

}  // namespace fleetloc
