#pragma once

#include <memory>
#include <string>

#include "shared/link/channel.hpp"
#include "shared/link/link_config.hpp"

namespace fleetloc {

/// Robots and localizers in one process and in simulated time: what DDS does between them, with the
/// same receivers, datagrams and header bytes, and nothing else (no discovery, no heartbeats).
///
/// A robot's uplink carries what it sends, its downlink what it receives; every robot has a link of
/// its own, unless all share one. A robot receives what is sent to it and every localizer's status;
/// a localizer receives what is sent to it. Session and localizer status are reliable and
/// transient-local: the last one of each sender is repeated until its receiver has it, or every
/// robot, late joiners included. The rest is best effort. Of each sender and topic a receiver gets
/// newer and newer samples only (BestEffortReader).
///
/// Time is the largest that was passed in; repetitions happen while it advances. The same
/// calls give the same result. One thread.
class MemoryNetwork {
 public:
  /// As the writers of session and localizer status in qos_profiles/.
  static constexpr Duration kRetransmission = std::chrono::seconds(1);

  /// Who has a link: each robot one as `link` says, or all of them the same one, as in one cell.
  enum class Links { kOnePerRobot, kShared };

  explicit MemoryNetwork(const LinkConfig& link, Links links = Links::kOnePerRobot);

  /// The ends of the network; each leaves the network when it is destroyed, and may outlive this
  /// object.
  std::unique_ptr<Channel> join_robot(const std::string& robot);
  std::unique_ptr<Channel> join_cloud(const std::string& localizer);

 private:
  class State;
  class End;

  std::unique_ptr<Channel> join(bool is_robot, const std::string& name);

  std::shared_ptr<State> state_;
};

}  // namespace fleetloc
