#include "shared/protocol/session_rule.hpp"

#include <utility>

namespace fleetloc {

SessionVerdict judge(const std::optional<RobotSession>& current, const RobotSession& sample) {
  if (!current) return SessionVerdict::kReplaces;
  const std::pair now(current->start_stamp, current->session);
  const std::pair then(sample.start_stamp, sample.session);
  if (then == now) return SessionVerdict::kRepeated;
  return then > now ? SessionVerdict::kReplaces : SessionVerdict::kOutdated;
}

}  // namespace fleetloc
