#pragma once

// Works around: nothing: parts of RTPS messages that the other files here read.
// Delete when: those are deleted.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace fleetloc {

/// The parts of an RTPS message (OMG, DDS Interoperability Wire Protocol 2.2, chapter 9.4): a
/// header, and submessages.
using RtpsBytes = std::span<const std::uint8_t>;

/// Of the GUIDs of a participant; in the header of what it sends.
using GuidPrefix = std::array<std::uint8_t, 12>;

inline constexpr std::size_t kRtpsHeaderBytes = 20;
inline constexpr std::size_t kEntitiesBytes = 8;               // reader and writer
inline constexpr std::size_t kGuidPrefixAt = 8;                // in the header
inline constexpr std::uint32_t kParticipantWriter = 0x0100c2;  // built-in, of announcements
inline constexpr std::uint32_t kHandshakeWriter = 0x0201c3;    // built-in, of DDS Security

/// @param message  at least its header
inline GuidPrefix sender_of(RtpsBytes message) {
  GuidPrefix prefix{};
  std::ranges::copy(message.subspan(kGuidPrefixAt, prefix.size()), prefix.begin());
  return prefix;
}

enum class RtpsKind : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoSource = 0x0c,
  kInfoDestination = 0x0e,
  kNackFrag = 0x12,
  kHeartbeatFrag = 0x13,
  kData = 0x15,
  kDataFrag = 0x16,
  kSecBody = 0x30,  ///< these five: DDS Security 1.1, chapter 7.3.6
  kSecPrefix = 0x31,
  kSecPostfix = 0x32,
  kSrtpsPrefix = 0x33,
  kSrtpsPostfix = 0x34,
  kStatistics = 0x80,  ///< of Fast DDS, behind every message
};

enum RtpsFlag : std::uint8_t {
  kLittleEndian = 0x01,
  kInlineQos = 0x02,
  kHasData = 0x04,
  kHasKey = 0x08
};

/// Reads fields in order; after one that is incomplete all are.
class RtpsFields {
 public:
  RtpsFields(RtpsBytes bytes, bool is_little_endian)
      : bytes_(bytes), is_little_endian_(is_little_endian) {}

  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::int64_t sequence_number() {
    const auto high = static_cast<std::int32_t>(u32());
    return (std::int64_t{high} << 32U) + u32();
  }
  RtpsBytes skip(std::size_t count) {
    if (count > bytes_.size()) {
      is_complete_ = false;
      bytes_ = {};
      return {};
    }
    const RtpsBytes taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  RtpsBytes rest() { return skip(bytes_.size()); }
  /// Of an entity of a participant; big endian always.
  std::uint32_t entity() {
    std::uint32_t id = 0;
    for (const std::uint8_t byte : skip(4)) id = (id << 8U) | byte;
    return id;
  }
  [[nodiscard]] bool is_complete() const { return is_complete_; }

 private:
  std::uint64_t number(std::size_t size) {
    std::uint64_t value = 0;
    const RtpsBytes taken = skip(size);
    for (std::size_t i = 0; i < taken.size(); ++i) {
      value = (value << 8U) | taken[is_little_endian_ ? taken.size() - 1 - i : i];
    }
    return value;
  }

  RtpsBytes bytes_;
  bool is_little_endian_;
  bool is_complete_ = true;
};

/// Leaves what comes after a list of parameters. False if it does not end, or is not one.
inline bool skip_parameters(RtpsFields& fields) {
  constexpr std::uint16_t kSentinel = 1;
  while (fields.is_complete()) {
    const std::uint16_t id = fields.u16();
    const std::uint16_t length = fields.u16();
    if (id == kSentinel) return fields.is_complete();
    if (length % 4 != 0) return false;
    fields.skip(length);
  }
  return false;
}

struct RtpsSubmessage {
  RtpsKind kind{};
  std::uint8_t flags = 0;
  RtpsBytes body;

  [[nodiscard]] RtpsFields fields() const { return {body, (flags & kLittleEndian) != 0}; }
};

/// Removes the first submessage from the rest of a message. Nothing if it is incomplete.
inline std::optional<RtpsSubmessage> take_submessage(RtpsBytes& rest) {
  if (rest.size() < 4) return std::nullopt;
  RtpsSubmessage submessage{.kind = static_cast<RtpsKind>(rest[0]), .flags = rest[1], .body = {}};
  RtpsFields length_field(rest.subspan(2, 2), (submessage.flags & kLittleEndian) != 0);
  std::size_t length = length_field.u16();
  rest = rest.subspan(4);
  // A length of 0 means: up to the end of the message.
  const bool may_be_empty =
      submessage.kind == RtpsKind::kPad || submessage.kind == RtpsKind::kInfoTimestamp;
  if (length == 0 && !may_be_empty) length = rest.size();
  if (length > rest.size()) return std::nullopt;
  submessage.body = rest.first(length);
  rest = rest.subspan(length);
  return submessage;
}

/// With which a participant announces itself, or says that it goes: then there is no data in it.
/// @param message  at least its header
inline std::optional<RtpsSubmessage> participant_sample_in(RtpsBytes message) {
  RtpsBytes rest = message.subspan(kRtpsHeaderBytes);
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind != RtpsKind::kData) continue;
    RtpsFields fields = submessage->fields();
    fields.skip(8);  // flags, offset of the inline QoS, reader
    if (fields.entity() == kParticipantWriter) return submessage;
  }
  return std::nullopt;
}

/// @param message  at least its header
inline bool is_announcement(RtpsBytes message) {
  const auto sample = participant_sample_in(message);
  return sample && (sample->flags & kHasData) != 0;
}

}  // namespace fleetloc
