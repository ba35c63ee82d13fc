#pragma once

// Works around: Fast DDS 2.9.1 trusts some fields of what it is sent: one malformed datagram ends
// the process by an assertion or an exception that nobody catches.
// Delete when: fuzzing test/transport/corruption_test.cpp without this check finds nothing.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "shared/core/expected.hpp"

namespace fleetloc {

/// Why a datagram is not well-formed RTPS.
enum class RtpsDefect : std::uint8_t {
  kNotRtps,            ///< no header of RTPS
  kVersion,            ///< another major version
  kCutShort,           ///< within a submessage
  kUnknownSubmessage,  ///< of a kind that neither RTPS 2.2 nor Fast DDS has
  kInvalidSubmessage,  ///< its fields contradict each other, or its length
  kStatistics,         ///< those of Fast DDS where it does not put them
  kTooManyGaps,        ///< see GapBudget
  kForeignGuid,        ///< in the name of a participant that is elsewhere, see KnownSenders
  kTooManySenders,     ///< of an address, or of all
  kFarAhead,           ///< a number that its writer cannot have reached yet, see SequenceBounds
  kProtection,  ///< of DDS Security: its submessages in another order, or not as long as they say
  kUnprotected  ///< see RtpsLimits::needs_protection
};
inline constexpr std::size_t kRtpsDefects = 12;
std::string_view name(RtpsDefect defect);

/// What is taken beside what the grammar says.
struct RtpsLimits {
  /// In fragments, of which the first makes the library take memory for all. By idl/ 300 KB at
  /// most.
  std::uint32_t largest_sample_bytes = 512U << 10U;
  /// Submessages of other vendors and of later versions, which Fast DDS skips; its own robots and
  /// localizers send none.
  bool allows_extensions = false;
  /// Who has keys hears nobody without: what writers and readers of a fleet's topics say is signed
  /// or encrypted. Discovery and the handshake begin in the clear.
  bool needs_protection = false;
};

/// Checks that a datagram conforms to the grammar of RTPS (OMG, DDS Interoperability Wire
/// Protocol 2.2, chapter 9.4): header, submessages within their lengths, sets, inline QoS and the
/// parameter lists of discovery. Fast DDS trusts what it is sent in places, and one malformed
/// datagram would end the program: pass it only datagrams that are well formed. The submessage that
/// Fast DDS puts behind each of its messages (statistics) is taken there only: the library asserts
/// its size and place. What DDS Security encrypts is not looked into: only who has the keys can
/// have sent it.
expected<void, RtpsDefect> check_rtps(std::span<const std::uint8_t> datagram,
                                      const RtpsLimits& limits = {});

}  // namespace fleetloc
