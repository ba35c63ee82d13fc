#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <optional>

#include "shared/link/link_model.hpp"

namespace fleetloc {

/// Which end of its link a participant is.
enum class ChannelRole { kRobot, kCloud };

/// Decides which datagrams of a participant arrive, and when. Any thread may use any function; the
/// directions do not wait for each other.
///
/// The link is that of a robot, at whichever end it is emulated: a robot's participant puts what it
/// sends on the uplink and what it receives on the downlink, a localizer's the other way round, for
/// all its robots together. Where both ends emulate a link, both count.
class EmulatedLink {
 public:
  using Time = std::chrono::steady_clock::time_point;

  EmulatedLink(ChannelRole role, const LinkConfig& link);

  /// Time at which a datagram leaves this computer; nothing if it is lost.
  /// @param bytes  payload of UDP
  std::optional<Time> outgoing_at(std::uint32_t bytes, Time now) {
    return outgoing_.arrival(bytes, now);
  }
  /// Time at which one reaches this computer; nothing if it is lost.
  std::optional<Time> incoming_at(std::uint32_t bytes, Time now) {
    return incoming_.arrival(bytes, now);
  }

 private:
  class Direction {
   public:
    Direction(const LinkDirection& direction, std::uint64_t seed) : model_(direction, seed) {}
    std::optional<Time> arrival(std::uint32_t bytes, Time now);

   private:
    std::mutex mutex_;
    LinkModel model_;  // guarded by mutex_
  };

  Direction outgoing_, incoming_;
};

}  // namespace fleetloc
