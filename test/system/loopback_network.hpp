#pragma once

#include <filesystem>
#include <string>

#include "test/system/child_program.hpp"
#include "test/transport/test_domain.hpp"

namespace fleetloc {

/// qos_profiles/lan.xml with its participants on the loopback interface, found by unicast, so that
/// a test reaches only its own programs, independent of the network; and a DDS domain.
class LoopbackNetwork {
 public:
  LoopbackNetwork();

  [[nodiscard]] std::string qos() const { return qos_.string(); }
  [[nodiscard]] std::string domain() const { return std::to_string(domain_.number()); }

 private:
  TestDomain domain_;
  ScratchFolder scratch_;
  std::filesystem::path qos_ = scratch_ / "loopback.xml";
};

/// Whether a network interface beside loopback is up that lan.xml can use.
bool has_multicast_interface();

}  // namespace fleetloc
