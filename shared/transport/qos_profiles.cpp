#include "shared/transport/qos_profiles.hpp"

#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include <arpa/inet.h>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <tinyxml2.h>

#include "shared/transport/transport_error.hpp"
#include "shared/transport/workarounds/library_log.hpp"

namespace fleetloc {
namespace {

using eprosima::fastrtps::xmlparser::XMLProfileManager;
using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;

constexpr const char* kBasedOn = "fleetloc:based_on";
constexpr const char* kProfileName = "profile_name";

struct Registry {
  std::mutex mutex;
  std::map<std::string, std::vector<NamedPeer>> named_peers;  // by profile; guarded by mutex
};

Registry& registry() {
  static Registry registry;
  return registry;
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason) {
  throw TransportError("cannot load QoS profiles from " + file.string() + ": " + reason);
}

void read(const std::filesystem::path& file, XMLDocument& document) {
  if (!std::filesystem::is_regular_file(file)) fail(file, "no such file");
  if (document.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS) fail(file, document.ErrorStr());
}

void parse(std::string_view xml, const std::string& name, XMLDocument& document) {
  if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) {
    fail(name, document.ErrorStr());
  }
}

// The element that holds the profiles: the root, or one in it.
XMLElement* profiles_of(XMLDocument& document) {
  XMLElement* root = document.RootElement();
  if (root == nullptr || std::string(root->Name()) == "profiles") return root;
  return root->FirstChildElement("profiles");
}

bool is_list(const XMLElement& element) {
  return std::string_view(element.Name()).ends_with("List");
}

std::string text_in(const XMLElement* parent, const char* name) {
  const XMLElement* element = parent == nullptr ? nullptr : parent->FirstChildElement(name);
  return element == nullptr || element->GetText() == nullptr ? "" : element->GetText();
}

// Of several properties that with the same name.
XMLElement* counterpart(XMLElement& parent, const XMLElement& wanted) {
  XMLElement* it = parent.FirstChildElement(wanted.Name());
  if (std::string_view(wanted.Name()) != "property") return it;
  while (it != nullptr && text_in(it, "name") != text_in(&wanted, "name")) {
    it = it->NextSiblingElement(wanted.Name());
  }
  return it;
}

// What `over` holds takes the place of what is there; lists (of peers, servers) do as a whole.
void lay_over(const XMLElement& over, XMLElement& base) {
  for (const XMLElement* it = over.FirstChildElement(); it != nullptr;
       it = it->NextSiblingElement()) {
    XMLElement* old = counterpart(base, *it);
    if (old != nullptr && it->FirstChildElement() != nullptr && !is_list(*it)) {
      lay_over(*it, *old);
      continue;
    }
    base.InsertEndChild(it->DeepClone(base.GetDocument()));
    if (old != nullptr) base.DeleteChild(old);
  }
}

bool is_address(const std::string& text) {
  in_addr ignored{};
  return inet_pton(AF_INET, text.c_str(), &ignored) == 1;
}

// What a profile, or a transport in the list of them, is told apart by; that list itself by
// nothing.
std::string name_of(const XMLElement& element) {
  const char* name = element.Attribute(kProfileName);
  return name == nullptr ? text_in(&element, "transport_id") : name;
}

XMLElement* namesake(XMLElement& parent, const XMLElement& wanted) {
  for (XMLElement* it = parent.FirstChildElement(wanted.Name()); it != nullptr;
       it = it->NextSiblingElement(wanted.Name())) {
    if (name_of(*it) == name_of(wanted)) return it;
  }
  return nullptr;
}

// Lays the profiles and transports of `file` over those of its base.
void lay_over(const XMLElement& profiles,
              const std::filesystem::path& file,
              XMLElement& base_profiles) {
  for (const XMLElement* it = profiles.FirstChildElement(); it != nullptr;
       it = it->NextSiblingElement()) {
    XMLElement* old = namesake(base_profiles, *it);
    if (old == nullptr) {
      fail(file, "its base has no such profile as in line " + std::to_string(it->GetLineNum()));
    }
    if (name_of(*it).empty()) {
      lay_over(*it, file, *old);
    } else {
      lay_over(*it, *old);
    }
  }
}

void lay_over(XMLDocument& document, const std::filesystem::path& file, XMLDocument& base) {
  const XMLElement* profiles = profiles_of(document);
  XMLElement* base_profiles = profiles_of(base);
  if (profiles == nullptr || base_profiles == nullptr) fail(file, "no profiles");
  lay_over(*profiles, file, *base_profiles);
}

/// The content of a file, laid over that of its base, which may have one as well.
/// @param depth  of a file that stands on itself there is no end
void read_over_base(const std::filesystem::path& file, XMLDocument& document, int depth = 0) {
  constexpr int kDeepest = 8;
  if (depth > kDeepest) fail(file, "its bases go round in a circle");
  read(file, document);
  const XMLElement* root = document.RootElement();
  const char* base_name = root == nullptr ? nullptr : root->Attribute(kBasedOn);
  if (base_name == nullptr) return;
  XMLDocument base;
  read_over_base(file.parent_path() / base_name, base, depth + 1);
  lay_over(document, file, base);
  base.DeepCopy(&document);
}

NamedPeer peer_at(const XMLElement& locator) {
  const XMLElement* udp = locator.FirstChildElement("udpv4");
  NamedPeer peer{.host = text_in(udp, "address"), .port = 0, .server_prefix = {}};
  const XMLElement* port = udp == nullptr ? nullptr : udp->FirstChildElement("port");
  if (port != nullptr) port->QueryUnsignedText(&peer.port);
  return peer;
}

// Removes the locators of `list` that are named by a host, or all, and returns them.
std::vector<NamedPeer> extracted(XMLElement& list, bool all) {
  std::vector<NamedPeer> peers;
  for (XMLElement* it = list.FirstChildElement("locator"); it != nullptr;) {
    XMLElement* locator = std::exchange(it, it->NextSiblingElement("locator"));
    NamedPeer peer = peer_at(*locator);
    if (peer.host.empty() || (!all && is_address(peer.host))) continue;
    peers.push_back(std::move(peer));
    list.DeleteChild(locator);
  }
  return peers;
}

void extract_initial_peers(XMLElement& builtin, std::vector<NamedPeer>& peers) {
  XMLElement* list = builtin.FirstChildElement("initialPeersList");
  if (list == nullptr) return;
  for (NamedPeer& peer : extracted(*list, false)) peers.push_back(std::move(peer));
  if (list->NoChildren()) builtin.DeleteChild(list);
}

// Also those with addresses, so that all servers are treated alike.
void extract_servers(XMLElement& discovery, std::vector<NamedPeer>& peers) {
  XMLElement* list = discovery.FirstChildElement("discoveryServersList");
  if (list == nullptr) return;
  for (XMLElement* server = list->FirstChildElement("RemoteServer"); server != nullptr;
       server = server->NextSiblingElement("RemoteServer")) {
    const char* prefix = server->Attribute("prefix");
    XMLElement* locators = server->FirstChildElement("metatrafficUnicastLocatorList");
    if (prefix == nullptr || locators == nullptr) continue;
    for (NamedPeer& peer : extracted(*locators, true)) {
      peer.server_prefix = prefix;
      peers.push_back(std::move(peer));
    }
  }
  discovery.DeleteChild(list);
}

std::map<std::string, std::vector<NamedPeer>> extract_named_peers(XMLElement& profiles) {
  std::map<std::string, std::vector<NamedPeer>> named;
  for (XMLElement* it = profiles.FirstChildElement("participant"); it != nullptr;
       it = it->NextSiblingElement("participant")) {
    const char* name = it->Attribute(kProfileName);
    XMLElement* rtps = it->FirstChildElement("rtps");
    XMLElement* builtin = rtps == nullptr ? nullptr : rtps->FirstChildElement("builtin");
    if (name == nullptr || builtin == nullptr) continue;
    std::vector<NamedPeer> peers;
    extract_initial_peers(*builtin, peers);
    if (XMLElement* discovery = builtin->FirstChildElement("discovery_config")) {
      extract_servers(*discovery, peers);
    }
    if (!peers.empty()) named[name] = std::move(peers);
  }
  return named;
}

void turn_off_intraprocess_delivery() {
  eprosima::fastrtps::LibrarySettingsAttributes settings = XMLProfileManager::library_settings();
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  XMLProfileManager::library_settings(settings);
}

/// @param file  in messages
void load(XMLDocument& document, const std::filesystem::path& file) {
  XMLElement* profiles = profiles_of(document);
  if (profiles == nullptr) fail(file, "no profiles");
  auto named = extract_named_peers(*profiles);

  const LibraryLog before = library_log();
  tinyxml2::XMLPrinter text;
  document.Print(&text);
  auto* factory = eprosima::fastdds::dds::DomainParticipantFactory::get_instance();
  const auto size = static_cast<std::size_t>(text.CStrSize()) - 1;
  const bool loaded =
      factory->load_XML_profiles_string(text.CStr(), size) == ReturnCode_t::RETCODE_OK;
  // A name that is taken is an error only in the library's log, and the old profile stays.
  const std::string reason = first_error_since(before);
  if (!loaded || !reason.empty()) fail(file, reason);
  turn_off_intraprocess_delivery();
  const std::lock_guard lock(registry().mutex);
  registry().named_peers.merge(named);
}

}  // namespace

void load_qos_profiles(const std::filesystem::path& file) {
  XMLDocument document;
  read_over_base(file, document);
  load(document, file);
}

void load_embedded_qos_profiles(std::string_view xml,
                                const std::string& name,
                                std::string_view over) {
  XMLDocument document;
  parse(xml, name, document);
  if (!over.empty()) {
    XMLDocument variant;
    parse(over, name, variant);
    lay_over(variant, name, document);
  }
  load(document, name);
}

std::vector<NamedPeer> named_peers(const std::string& participant_profile) {
  const std::lock_guard lock(registry().mutex);
  const auto found = registry().named_peers.find(participant_profile);
  return found == registry().named_peers.end() ? std::vector<NamedPeer>() : found->second;
}

}  // namespace fleetloc
