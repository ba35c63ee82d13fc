#pragma once

#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "shared/transport/topics.hpp"
#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// What a participant tells of itself in its user data: "fleetloc/1".
std::string wire_version_text(int version = kWireVersion);

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

  void announced(RtpsBytes parameters, bool is_little_endian);

  int own_;
  std::mutex mutex_;
  std::set<Program> seen_;           // guarded by mutex_
  std::vector<std::string> events_;  // guarded by mutex_
};

}  // namespace fleetloc
