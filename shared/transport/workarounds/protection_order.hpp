#pragma once

// Works around: Fast DDS 2.9.1 believes what DDS Security's submessages say of their lengths and of
// what follows them, before it looks at a signature.
// Delete when: datagram_check.hpp is deleted.

#include <cstdint>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// The order of the submessages with which DDS Security protects others (DDS Security 1.1, chapter
/// 7.3.6): a prefix, what it says that there is, a postfix; around one submessage, or around all.
class ProtectionOrder {
 public:
  /// @param is_first  in its message
  /// @param is_last   but for statistics
  /// @return false if it may not stand here, or is not as long as it says
  bool take(RtpsKind kind, RtpsBytes body, bool is_first, bool is_last);

  /// What comes next is signed, by itself or with its message.
  [[nodiscard]] bool is_protecting() const {
    return in_submessage_ || message_ != Protection::kNone;
  }
  [[nodiscard]] bool is_complete() const {
    return !in_submessage_ && !needs_body_ && message_ == Protection::kNone;
  }

 private:
  enum class Protection : std::uint8_t { kNone, kSigned, kEncrypted };

  static Protection protection_of(RtpsBytes prefix);
  bool begin(Protection protection);
  bool ends(Protection& protection);
  bool plain();

  Protection message_ = Protection::kNone;
  Protection submessage_ = Protection::kNone;
  bool in_submessage_ = false;
  bool has_content_ = false;
  bool needs_body_ = false;
  bool is_over_ = false;  ///< the encrypted body of a whole message has been there
};

}  // namespace fleetloc
