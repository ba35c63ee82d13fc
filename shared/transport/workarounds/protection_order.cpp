#include "shared/transport/workarounds/protection_order.hpp"

#include <cstddef>
#include <utility>

namespace fleetloc {
namespace {

// The library decrypts as many bytes as it says, before it looks at the signature.
bool is_secure_body(RtpsBytes body) {
  RtpsFields fields(body, false);
  const std::size_t size = fields.u32();
  return fields.is_complete() && size > 0 && size <= fields.rest().size();
}

// One signature, and one for each of some receivers; their number is big endian always.
bool is_secure_postfix(RtpsBytes body) {
  constexpr std::size_t kMac = 16;
  constexpr std::size_t kReceiverMac = 20;
  RtpsFields fields(body, false);
  fields.skip(kMac);
  const std::size_t receivers = fields.u32();
  return fields.is_complete() && fields.rest().size() == receivers * kReceiverMac;
}

}  // namespace

// Kinds of transformation (table 63): 1 and 3 sign, 2 and 4 encrypt.
ProtectionOrder::Protection ProtectionOrder::protection_of(RtpsBytes prefix) {
  constexpr std::size_t kPrefixBytes = 20;
  constexpr std::uint8_t kAes256Gcm = 4;
  if (prefix.size() != kPrefixBytes || prefix[0] != 0 || prefix[1] != 0 || prefix[2] != 0) {
    return Protection::kNone;
  }
  const std::uint8_t kind = prefix[3];
  if (kind == 0 || kind > kAes256Gcm) return Protection::kNone;
  return kind % 2 == 0 ? Protection::kEncrypted : Protection::kSigned;
}

bool ProtectionOrder::take(RtpsKind kind, RtpsBytes body, bool is_first, bool is_last) {
  switch (kind) {
    case RtpsKind::kSrtpsPrefix:
      message_ = protection_of(body);
      return is_first && begin(message_);
    case RtpsKind::kSrtpsPostfix:
      return is_last && ends(message_) && !in_submessage_ && is_secure_postfix(body);
    case RtpsKind::kSecPrefix:
      if (in_submessage_ || needs_body_ || is_over_) return false;
      in_submessage_ = true;
      submessage_ = protection_of(body);
      has_content_ = false;
      return begin(submessage_);
    case RtpsKind::kSecPostfix:
      if (!in_submessage_ || !has_content_) return false;
      in_submessage_ = false;
      return ends(submessage_) && is_secure_postfix(body);
    case RtpsKind::kSecBody:
      if (!needs_body_ || !is_secure_body(body)) return false;
      needs_body_ = false;
      has_content_ = true;
      is_over_ = !in_submessage_;
      return true;
    default:
      return plain();
  }
}

bool ProtectionOrder::begin(Protection protection) {
  needs_body_ = protection == Protection::kEncrypted;
  return protection != Protection::kNone;
}

bool ProtectionOrder::ends(Protection& protection) {
  const bool was_begun = std::exchange(protection, Protection::kNone) != Protection::kNone;
  is_over_ = false;
  return was_begun && !needs_body_;
}

// In a protected submessage there is one.
bool ProtectionOrder::plain() {
  if (needs_body_ || is_over_) return false;
  if (!in_submessage_) return true;
  return !std::exchange(has_content_, true);
}

}  // namespace fleetloc
