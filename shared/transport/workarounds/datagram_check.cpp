#include "shared/transport/workarounds/datagram_check.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>

#include "shared/transport/workarounds/parameter_check.hpp"
#include "shared/transport/workarounds/protection_order.hpp"
#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {
namespace {

using Bytes = RtpsBytes;
using Fields = RtpsFields;

constexpr std::array<std::uint8_t, 4> kMagic{'R', 'T', 'P', 'S'};
constexpr std::uint8_t kMajorVersion = 2;
constexpr std::uint32_t kMaxBitsOfASet = 256;
constexpr std::int64_t kMaxNumbers = 1 << 20;  // of samples in one range
constexpr std::int64_t kFarthest = std::numeric_limits<std::int64_t>::max();
constexpr std::size_t kStatisticsBytes = 56;
constexpr std::array<std::uint8_t, 2> kFastDds{1, 15};  // vendor
constexpr std::size_t kVendorAt = 6;                    // in the header

bool has_bitmap(Fields& fields) {
  const std::uint32_t bits = fields.u32();
  if (bits > kMaxBitsOfASet) return false;
  fields.skip(std::size_t{4} * ((bits + 31) / 32));
  return fields.is_complete();
}

// Discovery's own topics carry parameter lists; the vendor's and liveliness do not.
bool writes_parameters(std::uint32_t writer) {
  constexpr std::array<std::uint32_t, 4> kDiscovery{0x0100c2, 0x0003c2, 0x0004c2, 0x0002c2};
  return std::ranges::find(kDiscovery, writer) != kDiscovery.end();
}

bool is_payload(Bytes payload, std::uint32_t writer, const RtpsLimits& limits) {
  if (writer == kHandshakeWriter) {
    constexpr std::uint8_t kLittleEndianCdr = 1;  // 0: big endian
    return payload.size() >= 4 && payload[0] == 0 && payload[1] <= kLittleEndianCdr &&
           is_handshake_message(payload.subspan(4), payload[1] == kLittleEndianCdr);
  }
  if (!writes_parameters(writer)) return true;
  constexpr std::uint8_t kBigEndianList = 2;
  constexpr std::uint8_t kLittleEndianList = 3;
  if (payload.size() < 4 || payload[0] != 0) return false;
  if (payload[1] != kBigEndianList && payload[1] != kLittleEndianList) return false;
  return is_parameter_list(
      payload.subspan(4),
      payload[1] == kLittleEndianList,
      limits.allows_extensions ? ParameterSender::kAnybody : ParameterSender::kFastDds);
}

// What comes before inline QoS and payload, behind the fields that are common to DATA and
// DATA_FRAG, is `own` bytes long.
struct SampleHead {
  std::uint32_t writer = 0;
  std::int64_t number = 0;
  Bytes own;
};
std::optional<SampleHead> sample_head(Fields& fields, std::size_t own) {
  constexpr std::size_t kCommon = 16;  // reader, writer, sequence number: counted by the offset
  constexpr std::uint16_t kMaxOffset = std::numeric_limits<std::int16_t>::max();
  fields.u16();  // extra flags
  const std::uint16_t offset = fields.u16();
  if (offset < kCommon + own || offset > kMaxOffset) return std::nullopt;
  fields.u32();  // reader
  SampleHead head;
  head.writer = fields.entity();
  head.number = fields.sequence_number();
  head.own = fields.skip(own);
  fields.skip(offset - kCommon - own);
  if (!fields.is_complete() || head.number < 1) return std::nullopt;
  return head;
}

bool is_data(Fields fields, std::uint8_t flags, const RtpsLimits& limits) {
  const auto head = sample_head(fields, 0);
  if (!head) return false;
  if ((flags & kInlineQos) != 0 && !skip_parameters(fields)) return false;
  if ((flags & kHasData) != 0 && (flags & kHasKey) != 0) return false;
  return (flags & kHasData) == 0 || is_payload(fields.rest(), head->writer, limits);
}

// At the beginning of each fragment that is missing, aligned, the library writes a number of four
// bytes (CVE-2025-62799).
bool has_room_for_indices(std::uint32_t fragment, std::uint32_t sample) {
  constexpr std::uint32_t kIndex = 4;
  const std::uint32_t last_at = (sample - 1) / fragment * fragment;
  const std::uint32_t aligned = (last_at + kIndex - 1) / kIndex * kIndex;
  return fragment >= kIndex && aligned + kIndex <= sample;
}

bool is_data_frag(Fields fields, std::uint8_t flags, std::uint32_t largest_sample_bytes) {
  constexpr std::size_t kFragmentFields = 12;
  constexpr std::uint8_t kIsKeyOfFragments = 0x04;  // nobody sends it; read from nowhere
  const auto head = sample_head(fields, kFragmentFields);
  if (!head || writes_parameters(head->writer)) return false;  // those fit into one datagram
  if (head->writer == kHandshakeWriter) return false;          // the library does not split them
  if ((flags & kIsKeyOfFragments) != 0) return false;
  Fields own(head->own, (flags & kLittleEndian) != 0);
  const std::uint32_t first = own.u32();
  const std::uint32_t count = own.u16();
  const std::uint32_t size = own.u16();
  const std::uint32_t sample = own.u32();
  if (first == 0 || count == 0 || size == 0 || sample > largest_sample_bytes) return false;
  const std::uint32_t fragments = (sample + size - 1) / size;
  if (first > fragments || count > fragments - first + 1) return false;
  if (fragments > 1 && !has_room_for_indices(size, sample)) return false;
  if ((flags & kInlineQos) != 0 && !skip_parameters(fields)) return false;
  const std::size_t begin = std::size_t{first - 1} * size;
  const std::size_t end = std::min<std::size_t>(begin + std::size_t{count} * size, sample);
  return fields.rest().size() >= end - begin;
}

bool is_ack_nack(Fields fields) {
  fields.skip(8);
  const std::int64_t base = fields.sequence_number();  // 0: of a writer that is not known yet
  const bool has_set = base >= 0 && has_bitmap(fields);
  fields.u32();
  return has_set && fields.is_complete();
}

// The library walks through all numbers of a gap or a heartbeat.
bool is_range(std::int64_t first, std::int64_t end) {
  return first >= 1 && end >= first && end - first <= kMaxNumbers;
}

bool is_heartbeat(Fields fields) {
  fields.skip(8);  // reader, writer
  const std::int64_t first = fields.sequence_number();
  const std::int64_t last = fields.sequence_number();
  fields.u32();  // count
  return fields.is_complete() && last < kFarthest && is_range(first, last + 1);
}

bool is_gap(Fields fields) {
  fields.skip(8);
  const std::int64_t first = fields.sequence_number();
  const std::int64_t base = fields.sequence_number();
  return is_range(first, base) && has_bitmap(fields);
}

bool is_nack_frag(Fields fields) {
  fields.skip(8);
  const std::int64_t number = fields.sequence_number();
  const std::uint32_t base = fields.u32();
  const bool has_set = has_bitmap(fields);
  fields.u32();
  return number >= 1 && base >= 1 && has_set && fields.is_complete();
}

bool is_heartbeat_frag(Fields fields) {
  fields.skip(8);
  const std::int64_t number = fields.sequence_number();
  const std::uint32_t last = fields.u32();
  fields.u32();
  return number >= 1 && last >= 1 && fields.is_complete();
}

// Of a topic that a program has made; endpoints of discovery and security have other kinds
// (9.3.1.2).
bool is_of_a_topic(const RtpsSubmessage& submessage) {
  constexpr std::uint32_t kBuiltIn = 0xc0;
  constexpr std::size_t kFlagsAndOffset = 4;
  RtpsFields fields = submessage.fields();
  switch (submessage.kind) {
    case RtpsKind::kData:
    case RtpsKind::kDataFrag:
      fields.skip(kFlagsAndOffset);
      break;
    case RtpsKind::kAckNack:
    case RtpsKind::kHeartbeat:
    case RtpsKind::kGap:
    case RtpsKind::kNackFrag:
    case RtpsKind::kHeartbeatFrag:
      break;
    default:
      return false;
  }
  fields.entity();  // the reader, which may be all
  return (fields.entity() & kBuiltIn) == 0;
}

bool is_statistics(std::uint8_t flags, std::size_t length) {
  return (flags & kLittleEndian) != 0 && length == kStatisticsBytes;
}

// Nothing for a submessage of an unknown kind.
std::optional<bool> is_valid(const RtpsSubmessage& submessage, const RtpsLimits& limits) {
  const auto& [kind, flags, body] = submessage;
  const Fields fields = submessage.fields();
  switch (kind) {
    case RtpsKind::kPad:
      return true;
    case RtpsKind::kAckNack:
      return is_ack_nack(fields);
    case RtpsKind::kHeartbeat:
      return is_heartbeat(fields);
    case RtpsKind::kGap:
      return is_gap(fields);
    case RtpsKind::kInfoTimestamp:
      return (flags & kInlineQos) != 0 || body.size() >= 8;  // 2: no stamp
    case RtpsKind::kInfoSource:
      return body.size() >= kRtpsHeaderBytes;
    case RtpsKind::kInfoDestination:
      return body.size() >= 12;
    case RtpsKind::kNackFrag:
      return is_nack_frag(fields);
    case RtpsKind::kHeartbeatFrag:
      return is_heartbeat_frag(fields);
    case RtpsKind::kData:
      return is_data(fields, flags, limits);
    case RtpsKind::kDataFrag:
      return is_data_frag(fields, flags, limits.largest_sample_bytes);
    case RtpsKind::kSecBody:
    case RtpsKind::kSecPrefix:
    case RtpsKind::kSecPostfix:
    case RtpsKind::kSrtpsPrefix:
    case RtpsKind::kSrtpsPostfix:
      return true;  // see ProtectionOrder
    case RtpsKind::kStatistics:
      return is_statistics(flags, body.size());
  }
  return std::nullopt;
}

}  // namespace

std::string_view name(RtpsDefect defect) {
  switch (defect) {
    case RtpsDefect::kNotRtps:
      return "not_rtps";
    case RtpsDefect::kVersion:
      return "version";
    case RtpsDefect::kCutShort:
      return "cut_short";
    case RtpsDefect::kUnknownSubmessage:
      return "unknown_submessage";
    case RtpsDefect::kInvalidSubmessage:
      return "invalid_submessage";
    case RtpsDefect::kStatistics:
      return "statistics";
    case RtpsDefect::kTooManyGaps:
      return "too_many_gaps";
    case RtpsDefect::kForeignGuid:
      return "foreign_guid";
    case RtpsDefect::kTooManySenders:
      return "too_many_senders";
    case RtpsDefect::kFarAhead:
      return "far_ahead";
    case RtpsDefect::kProtection:
      return "protection";
    case RtpsDefect::kUnprotected:
      return "unprotected";
  }
  return "";
}

expected<void, RtpsDefect> check_rtps(std::span<const std::uint8_t> datagram,
                                      const RtpsLimits& limits) {
  const bool has_header =
      datagram.size() >= kRtpsHeaderBytes && std::ranges::equal(datagram.first(4), kMagic);
  if (!has_header) return unexpected(RtpsDefect::kNotRtps);
  if (datagram[4] != kMajorVersion) return unexpected(RtpsDefect::kVersion);
  const bool is_of_fast_dds = std::ranges::equal(datagram.subspan(kVendorAt, 2), kFastDds);
  Bytes rest = datagram.subspan(kRtpsHeaderBytes);
  ProtectionOrder order;
  for (bool is_first = true; !rest.empty(); is_first = false) {
    const auto submessage = take_submessage(rest);
    if (!submessage) return unexpected(RtpsDefect::kCutShort);
    const bool is_statistics = submessage->kind == RtpsKind::kStatistics;
    if (is_statistics && !is_of_fast_dds && limits.allows_extensions) continue;  // their own
    const std::optional<bool> valid = is_valid(*submessage, limits);
    if (!valid && limits.allows_extensions) continue;
    if (!valid) return unexpected(RtpsDefect::kUnknownSubmessage);
    if (is_statistics && (!*valid || !rest.empty())) return unexpected(RtpsDefect::kStatistics);
    if (!*valid) return unexpected(RtpsDefect::kInvalidSubmessage);
    if (is_statistics) continue;
    if (limits.needs_protection && !order.is_protecting() && is_of_a_topic(*submessage)) {
      return unexpected(RtpsDefect::kUnprotected);
    }
    const bool is_last = rest.empty() || static_cast<RtpsKind>(rest[0]) == RtpsKind::kStatistics;
    if (!order.take(submessage->kind, submessage->body, is_first, is_last)) {
      return unexpected(RtpsDefect::kProtection);
    }
  }
  if (!order.is_complete()) return unexpected(RtpsDefect::kProtection);
  return {};
}

}  // namespace fleetloc
