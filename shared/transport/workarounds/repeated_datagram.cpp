#include "shared/transport/workarounds/repeated_datagram.hpp"

#include <algorithm>

#include "shared/transport/workarounds/handshake_message.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

constexpr std::uint32_t kBuiltIn = 0xC0;  // in the kind of an entity (RTPS 2.2, table 9.1)
// Of the round trips of links that need a limit; the library repeats all of them when asked, and
// participants every time that they discover another one.
constexpr milliseconds kOfParticipant{2000};
constexpr milliseconds kOfEndpoint{1000};
constexpr milliseconds kOther{500};
// Encrypted, the repetitions of samples cannot be told from new ones: it is their requests that
// must not be repeated before they can be answered. With the first key, 0, both ends of the
// exchange of keys encrypt, so that one's heartbeats and the other's requests leave each other half
// the time.
constexpr milliseconds kEncrypted{2000};
constexpr milliseconds kOfKeys{1000};

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
  const auto handshake = HandshakeMessage::read(submessage);
  datagram.is_handshake |= handshake.has_value();
  datagram.is_secure |= handshake.has_value();
  for (auto* part : {&datagram.subject, &datagram.statement}) {
    part->push_back(static_cast<std::uint8_t>(submessage.kind));
    if (part == &datagram.statement) part->push_back(submessage.flags);
    append(entities, *part);
    if (handshake) {  // each repetition has another number, and the next message supersedes it
      if (part == &datagram.statement) append(handshake->content, *part);
    } else if (is_data || part == &datagram.statement) {
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

std::optional<RepeatedDatagram> RepeatedDatagram::read_encrypted(RtpsBytes datagram) {
  constexpr std::size_t kKeyAt = 4;  // behind the kind; then 12 bytes that are never the same
  constexpr std::size_t kKeyBytes = 4;
  constexpr std::size_t kPrefixBytes = 20;
  constexpr std::size_t kLongestWithoutSample = 76;  // an acknowledgement with the largest set
  if (datagram.size() < kRtpsHeaderBytes) return std::nullopt;
  RepeatedDatagram read;
  bool has_sample = false;
  RtpsBytes unique;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind == RtpsKind::kInfoDestination) append(submessage->body, read.subject);
    if (submessage->kind == RtpsKind::kSecPrefix) {
      if (submessage->body.size() != kPrefixBytes) return std::nullopt;
      const RtpsBytes key = submessage->body.subspan(kKeyAt, kKeyBytes);
      append(key, read.subject);
      unique = submessage->body.subspan(kKeyAt + kKeyBytes);
      const bool is_of_keys = std::ranges::count(key, 0) == kKeyBytes;
      read.worth_repeating_after =
          std::max(read.worth_repeating_after, is_of_keys ? kOfKeys : kEncrypted);
    }
    if (submessage->kind == RtpsKind::kSecBody) {
      has_sample |= submessage->body.size() > kLongestWithoutSample;
      read.subject.push_back(static_cast<std::uint8_t>(submessage->body.size()));
    }
  }
  if (read.worth_repeating_after == milliseconds{}) return std::nullopt;
  if (has_sample) append(unique, read.subject);
  read.statement = read.subject;
  read.is_secure = true;
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
