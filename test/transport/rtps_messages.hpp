#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "shared/link/channel.hpp"
#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

// RTPS messages, little endian, for tests.

class ByteWriter {
 public:
  ByteWriter& number(std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
    return *this;
  }
  ByteWriter& u16(std::uint64_t value) { return number(value, 2); }
  ByteWriter& u32(std::uint64_t value) { return number(value, 4); }
  ByteWriter& sequence_number(std::uint64_t value) { return u32(value >> 32U).u32(value); }
  ByteWriter& entity(std::uint32_t id) {  // big endian always
    for (const unsigned shift : {24U, 16U, 8U, 0U}) number(id >> shift, 1);
    return *this;
  }
  ByteWriter& bytes(const Bytes& more) {
    bytes_.insert(bytes_.end(), more.begin(), more.end());
    return *this;
  }
  ByteWriter& zeros(std::size_t count) { return bytes(Bytes(count)); }
  [[nodiscard]] const Bytes& written() const { return bytes_; }

 private:
  Bytes bytes_;
};

inline constexpr std::uint32_t kPublicationsWriter = 0x0003c2;
inline constexpr std::uint32_t kSubscriptionsReader = 0x0004c7;

inline Bytes submessage(std::uint8_t id, std::uint8_t flags, const Bytes& body) {
  return ByteWriter().number(id, 1).number(flags, 1).u16(body.size()).bytes(body).written();
}

inline Bytes message_of(const std::vector<Bytes>& submessages, const GuidPrefix& from = {}) {
  ByteWriter message;
  message.bytes({'R', 'T', 'P', 'S', 2, 3, 1, 15}).bytes({from.begin(), from.end()});
  for (const Bytes& one : submessages) message.bytes(one);
  return message.written();
}

inline Bytes ack_nack(std::uint32_t bits) {
  const std::size_t words = bits <= 1024 ? (bits + 31) / 32 : 8;
  return submessage(0x06,
                    1,
                    ByteWriter()
                        .entity(kSubscriptionsReader)
                        .entity(kPublicationsWriter)
                        .sequence_number(1)
                        .u32(bits)
                        .zeros(4 * words)
                        .u32(7)
                        .written());
}

inline Bytes heartbeat(std::uint64_t first,
                       std::uint64_t last,
                       std::uint32_t count = 9,
                       std::uint32_t writer = kPublicationsWriter) {
  return submessage(0x07,
                    1,
                    ByteWriter()
                        .entity(0)
                        .entity(writer)
                        .sequence_number(first)
                        .sequence_number(last)
                        .u32(count)
                        .written());
}

/// From `first` until before `base`, and some of what follows.
inline Bytes gap(std::uint64_t first, std::uint64_t base) {
  return submessage(0x08,
                    1,
                    ByteWriter()
                        .entity(0)
                        .entity(kPublicationsWriter)
                        .sequence_number(first)
                        .sequence_number(base)
                        .u32(32)
                        .zeros(4)
                        .written());
}

/// Of a sample in fragments of 1000 bytes.
inline Bytes data_frag(std::uint32_t first,
                       std::uint32_t sample_bytes,
                       std::uint32_t writer = 0x102) {
  return submessage(0x16,
                    1,
                    ByteWriter()
                        .u16(0)
                        .u16(28)
                        .entity(0)
                        .entity(writer)
                        .sequence_number(5)
                        .u32(first)
                        .u16(1)
                        .u16(1000)
                        .u32(sample_bytes)
                        .zeros(1000)
                        .written());
}

/// Of a participant, with parameters given by id and size.
inline Bytes announcement(const std::vector<std::pair<std::uint16_t, std::uint16_t>>& parameters) {
  ByteWriter body;
  body.u16(0).u16(16).entity(0).entity(kParticipantWriter).sequence_number(1);
  body.bytes({0, 3, 0, 0});  // a little endian parameter list
  for (const auto& [id, size] : parameters) body.u16(id).u16(size).zeros(size);
  body.u16(1).u16(0);
  return submessage(0x15, 1 | 4, body.written());
}

/// Names the participant whom what follows is for.
inline Bytes info_destination(const GuidPrefix& to) {
  return submessage(0x0e, 1, {to.begin(), to.end()});
}

/// A datagram in which a participant announces itself, without parameters.
inline Bytes announced_by(const GuidPrefix& from) {
  const auto body =
      ByteWriter().u16(0).u16(16).entity(0).entity(kParticipantWriter).sequence_number(1).zeros(8);
  return message_of({submessage(0x15, 1 | 4, body.written())}, from);
}

/// Of DDS Security. Kinds 1 and 3 sign, 2 and 4 encrypt.
inline Bytes secure_prefix(std::uint8_t kind, std::uint8_t id = 0x31, std::uint32_t key = 0) {
  return submessage(id, 1, ByteWriter().bytes({0, 0, 0, kind}).entity(key).zeros(12).written());
}
/// @param says  how many bytes are encrypted
inline Bytes secure_body(std::uint32_t says, std::size_t has) {
  return submessage(0x30, 1, ByteWriter().entity(says).zeros(has).written());
}
inline Bytes secure_postfix(std::uint32_t receivers, std::size_t has, std::uint8_t id = 0x32) {
  return submessage(id, 1, ByteWriter().zeros(16).entity(receivers).zeros(20 * has).written());
}
/// One of two participants that authenticate each other.
/// @param properties  that it says it has, of one
/// @param receiver    whom it is for
/// @param number      of the sample, another one in each repetition
inline Bytes handshake(std::uint32_t properties = 1,
                       const GuidPrefix& receiver = {},
                       std::uint64_t number = 1) {
  const auto text = [](ByteWriter& to) { to.u32(2).bytes({'a', 0, 0, 0}); };
  ByteWriter body;
  body.u16(0).u16(16).entity(0x0201c4).entity(kHandshakeWriter).sequence_number(number);
  body.bytes({0, 1, 0, 0}).zeros(48).bytes({receiver.begin(), receiver.end()}).zeros(36);
  text(body);
  body.u32(1);
  text(body);
  body.u32(properties);
  text(body);
  text(body);
  body.u32(0);
  return submessage(0x15, 1 | 4, body.written());
}

inline std::vector<std::pair<std::string, Bytes>> valid_submessages() {
  ByteWriter nack_frag;
  nack_frag.entity(0).entity(kPublicationsWriter).sequence_number(1).u32(1).u32(3).zeros(4).u32(1);
  ByteWriter heartbeat_frag;
  heartbeat_frag.entity(0).entity(kPublicationsWriter).sequence_number(1).u32(4).u32(2);
  ByteWriter data;
  data.u16(0).u16(16).entity(0).entity(0x102).sequence_number(2).bytes({0, 1, 0, 0}).zeros(40);
  return {{"ACKNACK", ack_nack(40)},
          {"HEARTBEAT", heartbeat(1, 4)},
          {"GAP", gap(1, 3)},
          {"INFO_TS", submessage(0x09, 1, Bytes(8))},
          {"INFO_SRC", submessage(0x0c, 1, Bytes(20))},
          {"INFO_DST", submessage(0x0e, 1, Bytes(12))},
          {"NACK_FRAG", submessage(0x12, 1, nack_frag.written())},
          {"HEARTBEAT_FRAG", submessage(0x13, 1, heartbeat_frag.written())},
          {"DATA", submessage(0x15, 1 | 4, data.written())},
          {"DATA_FRAG", data_frag(2, 5000)},
          {"statistics", submessage(0x80, 1, Bytes(56))},
          {"announcement", announcement({{0x0015, 4}, {0x0016, 4}, {0x0050, 16}})},
          {"handshake", handshake()}};
}

/// A datagram that is encrypted, with one submessage to one participant.
/// @param bytes  of what is encrypted: 28 for an acknowledgement without a set
inline Bytes encrypted_message(std::uint32_t key, std::uint32_t bytes, std::uint8_t to = 7) {
  return message_of({submessage(0x0e, 1, Bytes(12, to)),
                     secure_prefix(4, 0x31, key),
                     secure_body(bytes, bytes),
                     secure_postfix(0, 0)});
}

/// What goes through a network whose participants encrypt.
inline std::vector<Bytes> encrypted_submessage() {
  return {secure_prefix(4), secure_body(37, 40), secure_postfix(0, 0)};
}

/// Some valid submessages, most of them with a few bytes changed.
inline Bytes random_message(std::mt19937& random, const GuidPrefix& from = {}) {
  static const auto valid = valid_submessages();
  std::vector<Bytes> submessages(1 + random() % 3);
  for (Bytes& one : submessages) one = valid[random() % valid.size()].second;
  if (random() % 2 == 0) submessages.push_back(submessage(0x80, 1, Bytes(56)));
  Bytes message = message_of(submessages, from);
  constexpr std::size_t kHeader = 20;
  for (auto i = random() % 5; i > 0; --i) {
    constexpr std::array<std::uint8_t, 6> kBoundaryValues{0x00, 0x01, 0x7f, 0x80, 0xfe, 0xff};
    std::uint8_t& byte = message[kHeader + random() % (message.size() - kHeader)];
    byte = random() % 2 == 0 ? kBoundaryValues[random() % kBoundaryValues.size()]
                             : static_cast<std::uint8_t>(random());
  }
  if (random() % 8 == 0) message.resize(random() % message.size());
  return message;
}

}  // namespace fleetloc
