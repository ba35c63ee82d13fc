#pragma once

#include <atomic>
#include <mutex>
#include <optional>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Recognizes datagrams of a participant itself: a multicast comes back to its sender, though it
/// never left the computer. Any thread may use any function.
class OwnDatagrams {
 public:
  /// A datagram that the participant sends. The first tells its GUID prefix.
  void sent(RtpsBytes datagram);

  /// False until it has sent one.
  [[nodiscard]] bool includes(RtpsBytes datagram) const;

  /// Of the participant; nothing until it has sent one.
  [[nodiscard]] std::optional<GuidPrefix> prefix() const {
    if (!is_known_.load(std::memory_order_acquire)) return std::nullopt;
    return prefix_;
  }

  /// Of any participant of this process, whose GUID prefixes begin alike; false until it has sent
  /// one.
  [[nodiscard]] bool are_of_same_process(RtpsBytes datagram) const;

 private:
  std::once_flag learned_;
  std::atomic<bool> is_known_ = false;
  GuidPrefix prefix_{};  // written once, before is_known_
};

}  // namespace fleetloc
