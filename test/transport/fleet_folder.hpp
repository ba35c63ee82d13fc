#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "shared/transport/fleet_keys.hpp"
#include "shared/transport/transport_error.hpp"
#include "test/system/child_program.hpp"
#include "test/transport/test_network.hpp"

namespace fleetloc {

/// A fleet with keys, made by the tool that ships; removed with this object.
class FleetFolder {
 public:
  explicit FleetFolder(const std::string& fleet) { tool({"ca", "--fleet", fleet}); }

  /// Runs the tool with these words. Throws std::runtime_error with what it said.
  void tool(std::vector<std::string> words) const {
    words.insert(words.begin(), {"--dir", path("fleet").string()});
    const Outcome outcome = run(FLEETLOC_SOURCE_DIR "/deploy/security/fleet-keys.sh", words);
    if (outcome.exit_code != 0) throw std::runtime_error(outcome.errors);
  }

  /// The folder of a member, which is made if it is not there yet.
  [[nodiscard]] std::filesystem::path member(const std::string& role,
                                             const std::string& name) const {
    auto folder = path("fleet") / (role + "s") / name;
    if (!std::filesystem::exists(folder)) tool({role, name});
    return folder;
  }
  [[nodiscard]] FleetKeys keys(const std::string& role, const std::string& name) const {
    return FleetKeys(member(role, name));
  }
  [[nodiscard]] std::filesystem::path ca() const { return path("fleet") / "ca"; }
  [[nodiscard]] std::filesystem::path path(const std::string& name) const {
    return scratch_ / name;
  }

 private:
  ScratchFolder scratch_;
};

/// lan-secure.xml as it ships, the participants on loopback. Once per process.
inline void load_secure_profiles() {
  static const bool loaded = [] {
    load_qos_profiles(FLEETLOC_SOURCE_DIR "/qos_profiles/lan-secure.xml");
    load_qos_profiles(FLEETLOC_SOURCE_DIR "/test/transport/loopback.xml");
    load_qos_profiles(FLEETLOC_SOURCE_DIR "/test/transport/loopback-secure.xml");
    return true;
  }();
  static_cast<void>(loaded);
}

inline DdsChannel::Config secure_on_loopback(std::uint32_t domain,
                                             ChannelRole role,
                                             const std::string& name,
                                             const FleetKeys& keys) {
  return {.domain = domain,
          .participant_profile = "secure_loopback",
          .role = role,
          .name = name,
          .link = std::nullopt,
          .keys = keys};
}

/// Of a member of the fleet, which is made if it is not there yet.
inline DdsChannel::Config secure_on_loopback(std::uint32_t domain,
                                             ChannelRole role,
                                             const std::string& name,
                                             const FleetFolder& fleet) {
  const std::string kind = role == ChannelRole::kRobot ? "robot" : "localizer";
  return secure_on_loopback(domain, role, name, fleet.keys(kind, name));
}

/// What a TransportError says.
template <typename Action>
std::string refusal(const Action& action) {
  try {
    action();
  } catch (const TransportError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace fleetloc
