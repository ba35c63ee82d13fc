#include "shared/transport/workarounds/spoken_of.hpp"

#include <algorithm>
#include <array>

namespace fleetloc {
namespace {

constexpr std::array<std::uint32_t, 4> kDiscoveryWriters{
    kParticipantWriter, 0x0003c2, 0x0004c2, 0x0002c2};
// Parameters (DDS Interoperability Wire Protocol 2.2, chapter 9.6.2.2.2).
constexpr std::uint16_t kListSentinel = 0x0001;
constexpr std::uint16_t kDefaultUnicastLocator = 0x0031;
constexpr std::uint16_t kMetatrafficUnicastLocator = 0x0032;
constexpr std::uint16_t kGuidOfParticipant = 0x0050;
constexpr std::uint16_t kGuidOfEndpoint = 0x005a;
constexpr std::uint16_t kKeyHash = 0x0070;
constexpr std::size_t kEncapsulation = 4;

GuidPrefix prefix_in(RtpsBytes guid) {
  GuidPrefix prefix{};
  if (guid.size() >= prefix.size()) std::ranges::copy(guid.first(prefix.size()), prefix.begin());
  return prefix;
}

std::optional<std::uint32_t> ipv4_in(RtpsBytes locator, bool is_little_endian) {
  constexpr std::uint32_t kUdpV4 = 1;
  RtpsFields fields(locator, is_little_endian);
  const bool is_ipv4 = fields.u32() == kUdpV4;
  fields.skip(4 + 12);  // port, and what comes before the address
  const std::uint32_t address = fields.entity();
  return is_ipv4 && fields.is_complete() ? std::optional(address) : std::nullopt;
}

void read_parameters(RtpsFields& fields, bool is_little_endian, DiscoverySample& sample) {
  while (fields.is_complete()) {
    const std::uint16_t id = fields.u16();
    const RtpsBytes value = fields.skip(fields.u16());
    if (id == kListSentinel) return;
    if (id == kGuidOfParticipant || id == kGuidOfEndpoint || id == kKeyHash) {
      sample.of = prefix_in(value);
    } else if (id == kDefaultUnicastLocator || id == kMetatrafficUnicastLocator) {
      const auto address = ipv4_in(value, is_little_endian);
      if (address) sample.addresses.insert(*address);
    }
  }
}

}  // namespace

std::optional<DiscoverySample> discovery_sample(const RtpsSubmessage& data) {
  RtpsFields fields = data.fields();
  fields.skip(4);  // extra flags, offset of the inline QoS: the three fields that follow
  fields.entity();
  const std::uint32_t writer = fields.entity();
  if (std::ranges::find(kDiscoveryWriters, writer) == kDiscoveryWriters.end()) return std::nullopt;
  fields.sequence_number();
  DiscoverySample sample;
  if ((data.flags & kInlineQos) != 0) {
    read_parameters(fields, (data.flags & kLittleEndian) != 0, sample);
  }
  if ((data.flags & (kHasData | kHasKey)) == 0) return sample;
  sample.is_announcement = writer == kParticipantWriter && (data.flags & kHasData) != 0;
  const RtpsBytes payload = fields.rest();
  if (payload.size() < kEncapsulation) return sample;
  constexpr std::uint8_t kLittleEndianList = 3;
  const bool is_little_endian = payload[1] == kLittleEndianList;
  RtpsFields parameters(payload.subspan(kEncapsulation), is_little_endian);
  read_parameters(parameters, is_little_endian, sample);
  return sample;
}

}  // namespace fleetloc
