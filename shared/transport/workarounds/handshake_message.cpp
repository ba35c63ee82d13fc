#include "shared/transport/workarounds/handshake_message.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;
constexpr std::size_t kIdentityBytes = 24;  // of a message: its writer and number

}  // namespace

std::optional<HandshakeMessage> HandshakeMessage::read(const RtpsSubmessage& submessage) {
  if (submessage.kind != RtpsKind::kData || (submessage.flags & kHasData) == 0) return std::nullopt;
  RtpsFields fields = submessage.fields();
  fields.skip(8);  // flags, offset of the inline QoS, reader
  if (fields.entity() != kHandshakeWriter) return std::nullopt;
  fields.sequence_number();
  if ((submessage.flags & kInlineQos) != 0) skip_parameters(fields);
  HandshakeMessage message{.receiver = {}, .content = fields.rest()};
  RtpsFields content(message.content, true);
  content.skip(kEncapsulationBytes + 2 * kIdentityBytes);  // its own, and of what it answers
  const RtpsBytes receiver = content.skip(message.receiver.size());
  if (!content.is_complete()) return std::nullopt;
  std::ranges::copy(receiver, message.receiver.begin());
  return message;
}

bool is_handshake_for_another(RtpsBytes datagram) {
  if (datagram.size() < kRtpsHeaderBytes) return false;
  RtpsBytes rest = datagram.subspan(kRtpsHeaderBytes);
  RtpsBytes destination;
  while (const auto submessage = take_submessage(rest)) {
    if (submessage->kind == RtpsKind::kInfoDestination) destination = submessage->body;
    const auto message = HandshakeMessage::read(*submessage);
    if (!message) continue;
    return !destination.empty() && !std::ranges::equal(destination, message->receiver);
  }
  return false;
}

}  // namespace fleetloc
