#pragma once

#include <cstdint>
#include <mutex>
#include <set>
#include <vector>

#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/network/SenderResource.h>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// How this participant announced itself last, and where to. Any thread may use any function.
class LatestAnnouncement {
 public:
  using LocatorList = eprosima::fastdds::rtps::LocatorList;
  using Socket = eprosima::fastrtps::rtps::SenderResource;

  struct Sent {
    std::vector<std::uint8_t> datagram;  ///< empty until there is one
    LocatorList destinations;
    std::set<Socket*> sockets;  ///< all that it was given to, one after the other
  };

  /// @param datagram  any that is sent
  void sent(Socket* socket, RtpsBytes datagram, const LocatorList& destinations) {
    if (!participant_sample_in(datagram)) return;
    const std::lock_guard lock(mutex_);
    latest_.datagram.clear();  // nobody who has said that he goes is announced again
    if (!is_announcement(datagram)) return;
    latest_.datagram.assign(datagram.begin(), datagram.end());
    latest_.destinations = destinations;
    latest_.sockets.insert(socket);
  }

  [[nodiscard]] Sent latest() const {
    const std::lock_guard lock(mutex_);
    return latest_;
  }

 private:
  mutable std::mutex mutex_;
  Sent latest_;  // guarded by mutex_
};

}  // namespace fleetloc
