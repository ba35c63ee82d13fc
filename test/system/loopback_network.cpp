#include "test/system/loopback_network.hpp"

#include <fstream>
#include <stdexcept>

#include <ifaddrs.h>
#include <net/if.h>
#include <sys/socket.h>

namespace fleetloc {
namespace {

/// Replaces `part` wherever `text` has it; that must be `times`.
std::string replaced(std::string text, const std::string& part, const std::string& by, int times) {
  int found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + by.size())) {
    text.replace(at, part.size(), by);
    ++found;
  }
  if (found != times) throw std::runtime_error("lan.xml is no longer as expected at " + part);
  return text;
}

std::string on_loopback(const std::string& lan) {
  const std::string end_of_discovery = "</discovery_config>\n      </builtin>";
  std::string moved = lan;
  for (const char* transport : {"udp", "udp_cloud"}) {
    const std::string type =
        std::string("<transport_id>") + transport + "</transport_id>\n      <type>UDPv4</type>";
    moved = replaced(moved,
                     type,
                     type +
                         "<interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>"
                         "<maxInitialPeersRange>16</maxInitialPeersRange>",
                     1);
  }
  return replaced(moved,
                  end_of_discovery,
                  "</discovery_config><initialPeersList><locator><udpv4><address>127.0.0.1"
                  "</address></udpv4></locator></initialPeersList></builtin>",
                  2);  // robot and cloud
}

}  // namespace

LoopbackNetwork::LoopbackNetwork() {
  std::ofstream(qos_) << on_loopback(content_of(FLEETLOC_SOURCE_DIR "/qos_profiles/lan.xml"));
}

bool has_multicast_interface() {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) return false;
  bool found = false;
  for (const ifaddrs* it = first; it != nullptr; it = it->ifa_next) {
    const unsigned flags = it->ifa_flags;
    found = found || (it->ifa_addr != nullptr && it->ifa_addr->sa_family == AF_INET &&
                      (flags & IFF_UP) != 0 && (flags & IFF_RUNNING) != 0 &&
                      (flags & IFF_MULTICAST) != 0 && (flags & IFF_LOOPBACK) == 0);
  }
  freeifaddrs(first);
  return found;
}

}  // namespace fleetloc
