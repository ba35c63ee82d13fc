#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <vector>

#include <fastdds/rtps/network/SenderResource.h>

#include "shared/transport/locators.hpp"

namespace fleetloc {

/// A socket of Fast DDS that sends nothing, and remembers what it was to send. Any thread may use
/// any function.
class RecordingSocket final : public eprosima::fastrtps::rtps::SenderResource {
 public:
  using Clock = std::chrono::steady_clock;

  struct Sent {
    std::vector<std::uint8_t> datagram;
    PeerAddressFilter::Locator to;
    Clock::time_point at;
  };

  RecordingSocket() : SenderResource(LOCATOR_KIND_UDPv4) {
    send_lambda_ = [this](const auto* bytes, auto size, auto* first, auto* last, const auto&) {
      const std::lock_guard lock(mutex_);
      for (; *first != *last; ++*first) {
        sent_.push_back({{bytes, bytes + size}, locator_of(**first), Clock::now()});
      }
      changed_.notify_all();
      return true;
    };
  }

  /// What was sent, once it is as many; after `patience` what there is.
  std::vector<Sent> wait_for(std::size_t number,
                             Clock::duration patience = std::chrono::seconds(10)) const {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, patience, [&] { return sent_.size() >= number; });
    return sent_;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::vector<Sent> sent_;  // guarded by mutex_
};

}  // namespace fleetloc
