#include "test/fuzz/seeds.hpp"
#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

void add_text(ByteWriter& to, const std::string& text) {
  const std::size_t size = text.size() + 1;
  to.u32(size).bytes({text.begin(), text.end()}).zeros(1 + (4 - size % 4) % 4);
}

Bytes content(const std::string& text, std::uint32_t count = 0) {
  ByteWriter written;
  if (count > 0) written.u32(count);
  add_text(written, text);
  for (std::uint32_t i = 1; i < 2 * count; ++i) add_text(written, "value");
  return written.written();
}

Bytes octets(const std::string& text) {
  return ByteWriter().u32(text.size()).bytes({text.begin(), text.end()}).written();
}

/// As a participant describes itself, without what is behind the list.
Bytes parameters() {
  ByteWriter list;
  const auto add = [&](std::uint16_t id, const Bytes& value) {
    const std::size_t padding = (4 - value.size() % 4) % 4;
    list.u16(id).u16(value.size() + padding).bytes(value).zeros(padding);
  };
  add(0x0050, Bytes(16, 7));                                       // GUID
  add(0x0062, content("robot_1"));                                 // name
  add(0x002c, octets("fleetloc/2/robot"));                         // user data
  add(0x0059, content("fleetloc.property", 1));                    // properties
  add(0x0031, ByteWriter().u32(1).u32(7411).zeros(16).written());  // an address
  add(0x0005, content("fleetloc/2/cloud/session"));                // topic
  add(0x0029, ByteWriter().u32(1).bytes(content("part")).written());
  add(0x0073, ByteWriter().u32(1).u16(0).u16(0).written());  // representations
  return list.u16(1).u16(0).written();
}

}  // namespace

void add_rtps_seeds(const SeedFolder& seeds) {
  for (const auto& [name, submessage] : valid_submessages()) {
    seeds.add("net_datagram", name, message_of({submessage}));
  }
  const Bytes statistics = submessage(0x80, 1, Bytes(56));
  seeds.add("net_datagram",
            "several",
            message_of({submessage(0x0e, 1, Bytes(12)), heartbeat(1, 2), gap(3, 9), statistics}));
  seeds.add("net_datagram", "encrypted", message_of(encrypted_submessage()));
  seeds.add("net_datagram",
            "signed",
            message_of({secure_prefix(3), heartbeat(1, 2), secure_postfix(1, 1)}));
  ByteWriter announced;
  announced.u16(0).u16(16).entity(0).entity(kParticipantWriter).sequence_number(1);
  announced.bytes({0, 3, 0, 0}).bytes(parameters());
  seeds.add("net_datagram",
            "announced",
            message_of({submessage(0x15, 1 | 4, announced.written())}, GuidPrefix{7, 7, 7}));
  seeds.add("net_parameters", "participant", parameters());
  ByteWriter handshake;
  handshake.zeros(96).bytes(content("dds.sec.auth")).u32(1).bytes(content("DDS:Auth"));
  handshake.u32(1).bytes(content("a")).bytes(content("b")).u32(1).bytes(content("c"));
  seeds.add("net_parameters", "handshake", handshake.bytes(octets("abcd")).written());
}

}  // namespace fleetloc
