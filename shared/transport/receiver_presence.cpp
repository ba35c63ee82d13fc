#include "shared/transport/receiver_presence.hpp"

namespace fleetloc {

std::vector<std::string> ReceiverPresence::absent(const std::set<std::string>& receivers,
                                                  const std::set<std::string>& present,
                                                  Time now) {
  std::erase_if(seen_, [&](const auto& one) { return !receivers.contains(one.first); });
  std::vector<std::string> absent;
  for (const std::string& receiver : receivers) {
    const auto seen = seen_.try_emplace(receiver, now).first;
    if (present.contains(receiver)) seen->second = now;
    if (now - seen->second <= patience_) continue;
    absent.push_back(receiver);
    seen_.erase(seen);
  }
  return absent;
}

}  // namespace fleetloc
