#pragma once

#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/transport/emulated_link.hpp"
#include "shared/transport/topics.hpp"
#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// What a participant tells of itself in its user data: "fleetloc/2", a robot "fleetloc/2/robot".
std::string wire_version_text(int version = kWireVersion);
std::string wire_version_text(ChannelRole role);

/// Whether a robot announces itself with this datagram. Other robots have nothing to do with it,
/// and the endpoints of each would cost all of them some KB.
/// @param datagram  well-formed RTPS
bool announces_robot(RtpsBytes datagram);

/// Notices programs of fleetloc that speak another version of the wire: they share no topic with
/// this one, so neither would ever know why it is alone. Reads the announcements of participants,
/// since Fast DDS has no built-in topic for them. Programs from before the first version, which say
/// nothing of one, count as version 0. Any thread may use any function.
class WireVersionWatch {
 public:
  explicit WireVersionWatch(int own = kWireVersion) : own_(own) {}

  /// @param datagram  well-formed RTPS
  void observe(RtpsBytes datagram);

  /// Each kind of program and version once, a line for a log.
  std::vector<std::string> take_events();

 private:
  using Program = std::pair<std::string, int>;  // name of the participant, version

  void observe(std::string_view name, std::string_view user_data);

  int own_;
  std::mutex mutex_;
  std::set<Program> seen_;           // guarded by mutex_
  std::vector<std::string> events_;  // guarded by mutex_
};

}  // namespace fleetloc
