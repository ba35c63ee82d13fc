#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <vector>

#include "shared/link/link_model.hpp"

namespace fleetloc {

/// Which end of its link a participant is.
enum class ChannelRole { kRobot, kCloud };

/// Decides which datagrams of a participant arrive, when, and how often. Any thread may use any
/// function; the directions do not wait for each other.
///
/// The link is that of a robot, at whichever end it is emulated: a robot's participant puts what it
/// sends on the uplink and what it receives on the downlink, a localizer's the other way round, for
/// all its robots together. Where both ends emulate a link, both count.
class EmulatedLink {
 public:
  using Time = std::chrono::steady_clock::time_point;

  EmulatedLink(ChannelRole role, const LinkConfig& link);

  /// Times at which the copies of a datagram leave this computer; none if it is lost.
  /// @param bytes  payload of UDP
  std::vector<Time> outgoing_at(std::uint32_t bytes, Time now) {
    start(now);
    return outgoing_.arrivals(bytes, now);
  }
  /// Times at which those of one reach this computer; none if it is lost.
  std::vector<Time> incoming_at(std::uint32_t bytes, Time now) {
    start(now);
    return incoming_.arrivals(bytes, now);
  }

 private:
  class Direction {
   public:
    Direction(const LinkDirection& direction, std::uint64_t seed) : model_(direction, seed) {}
    void start(Time now);
    std::vector<Time> arrivals(std::uint32_t bytes, Time now);

   private:
    std::mutex mutex_;
    LinkModel model_;  // guarded by mutex_
  };

  /// Both directions have one time.
  void start(Time now);

  std::once_flag started_;
  Direction outgoing_, incoming_;
};

}  // namespace fleetloc
