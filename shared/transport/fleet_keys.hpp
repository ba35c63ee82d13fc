#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include <fastdds/rtps/attributes/PropertyPolicy.h>

namespace fleetloc {

/// What a member of a fleet is, in the subject of its certificate.
enum class FleetRole : std::uint8_t { kRobot, kLocalizer, kMonitor, kObserver };

/// The folder of a member of a fleet, as deploy/security/fleet-keys.sh makes it: its key, its
/// certificate, its signed permissions and the fleet's rules, for DDS Security.
class FleetKeys {
 public:
  /// Throws TransportError that names the file that is missing, cannot be read, can be read by
  /// others (the key), has ended, or does not belong to the others.
  explicit FleetKeys(std::filesystem::path folder);

  [[nodiscard]] const std::string& name() const { return name_; }  ///< of the member
  [[nodiscard]] FleetRole role() const { return role_; }
  /// Throws TransportError if the keys are another member's.
  void require(FleetRole role, const std::string& name) const;

  /// Makes a participant a member of the fleet.
  void add_to(eprosima::fastrtps::rtps::PropertyPolicy& properties) const;

  /// How the GUIDs of a member's participants begin: with 47 bits of the hash of its certificate's
  /// subject (DDS Security 1.1, table 52). Fast DDS refuses a handshake that does not hold to it.
  using GuidBegin = std::array<std::uint8_t, 6>;
  [[nodiscard]] GuidBegin guid_begin(FleetRole role, const std::string& name) const;

 private:
  std::filesystem::path folder_;
  std::string fleet_;
  std::string name_;
  FleetRole role_{};
};

}  // namespace fleetloc
