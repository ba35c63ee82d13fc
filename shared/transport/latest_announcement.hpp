#pragma once

#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include <fastdds/rtps/common/LocatorList.hpp>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// How this participant announced itself last, and where to. Any thread may use any function.
class LatestAnnouncement {
 public:
  using LocatorList = eprosima::fastdds::rtps::LocatorList;

  void sent(RtpsBytes datagram, const LocatorList& destinations) {
    if (!participant_sample_in(datagram)) return;
    const std::lock_guard lock(mutex_);
    datagram_.clear();  // nobody who has said that he goes is announced again
    if (!is_announcement(datagram)) return;
    datagram_.assign(datagram.begin(), datagram.end());
    destinations_ = destinations;
  }

  /// Empty until there is one.
  [[nodiscard]] std::pair<std::vector<std::uint8_t>, LocatorList> latest() const {
    const std::lock_guard lock(mutex_);
    return {datagram_, destinations_};
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::uint8_t> datagram_;  // guarded by mutex_
  LocatorList destinations_;            // guarded by mutex_
};

}  // namespace fleetloc
