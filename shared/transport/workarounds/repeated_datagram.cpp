#include "shared/transport/workarounds/repeated_datagram.hpp"

#include <algorithm>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

constexpr std::uint32_t kBuiltIn = 0xC0;  // in the kind of an entity (RTPS 2.2, table 9.1)
// Of the round trips of links that need a limit; the library repeats all of them when asked, and
// participants every time that they discover another one.
constexpr milliseconds kOfParticipant{2000};
constexpr milliseconds kOfEndpoint{1000};
constexpr milliseconds kOther{500};

void append(RtpsBytes bytes, std::vector<std::uint8_t>& to) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// @param is_reliable  set if the submessage is one that only reliable endpoints send
/// @return false if it is none that is repeated
bool add(const RtpsSubmessage& submessage, RepeatedDatagram& datagram, bool& is_reliable) {
  std::size_t skipped = 0;  // before reader and writer
  std::size_t said = 0;     // behind them; of an ACKNACK and a GAP all but the count
  switch (submessage.kind) {
    case RtpsKind::kPad:
    case RtpsKind::kInfoTimestamp:
    case RtpsKind::kStatistics:
      return true;
    case RtpsKind::kInfoDestination:
      append(submessage.body, datagram.subject);
      append(submessage.body, datagram.statement);
      return true;
    case RtpsKind::kData:
      skipped = 4;
      said = 8;
      break;
    case RtpsKind::kHeartbeat:
      said = 16;
      break;
    case RtpsKind::kAckNack:
      said = submessage.body.size() - std::min<std::size_t>(submessage.body.size(), 12);
      break;
    case RtpsKind::kGap:
      said = submessage.body.size() - std::min<std::size_t>(submessage.body.size(), 8);
      break;
    default:
      return false;
  }
  if (submessage.body.size() < skipped + kEntitiesBytes + said) return false;
  const RtpsBytes entities = submessage.body.subspan(skipped, kEntitiesBytes);
  RtpsFields fields(entities.last(4), true);
  const std::uint32_t writer = fields.entity();
  datagram.is_discovery &= (writer & kBuiltIn) == kBuiltIn;
  const bool is_data = submessage.kind == RtpsKind::kData;
  for (auto* part : {&datagram.subject, &datagram.statement}) {
    part->push_back(static_cast<std::uint8_t>(submessage.kind));
    if (part == &datagram.statement) part->push_back(submessage.flags);
    append(entities, *part);
    if (is_data || part == &datagram.statement) {
      append(submessage.body.subspan(skipped + kEntitiesBytes, said), *part);
    }
  }
  const milliseconds pause = writer == kParticipantWriter ? kOfParticipant
                             : is_data                    ? kOfEndpoint
                                                          : kOther;
  datagram.worth_repeating_after = std::max(datagram.worth_repeating_after, pause);
  is_reliable |= !is_data;
  return true;
}

}  // namespace

std::optional<RepeatedDatagram> RepeatedDatagram::read(RtpsBytes datagram) {
  if (datagram.size() < kRtpsHeaderBytes) return std::nullopt;
  RepeatedDatagram read;
  bool is_reliable = false;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (!rest.empty()) {
    const auto submessage = take_submessage(rest);
    if (!submessage || !add(*submessage, read, is_reliable)) return std::nullopt;
  }
  if (read.worth_repeating_after == milliseconds{}) return std::nullopt;
  if (!read.is_discovery && !is_reliable) return std::nullopt;
  return read;
}

void RepeatedDatagram::address_to(const void* socket, const PeerAddressFilter::Locator& to) {
  const auto append = [this](const auto& value) {
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(&value);
    for (auto* part : {&subject, &statement})
      part->insert(part->end(), bytes, bytes + sizeof(value));
  };
  append(socket);
  append(to.address);
  append(to.port);
}

}  // namespace fleetloc
