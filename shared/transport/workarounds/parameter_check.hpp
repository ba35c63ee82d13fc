#pragma once

// Works around: Fast DDS 2.9.1 believes the lengths that stand within the parameters of discovery,
// and takes memory for them, or reads behind the end: CVE-2024-30258, CVE-2024-30259,
// CVE-2025-62599 to -62603, CVE-2025-64098, CVE-2026-49861, CVE-2026-55063, CVE-2026-53590.
// Delete when: the library checks them.

#include <cstdint>

#include "shared/transport/workarounds/rtps_message.hpp"

namespace fleetloc {

/// Who may send a list.
enum class ParameterSender : std::uint8_t {
  kFastDds,  ///< one of ours: neither describes its types nor filters by content
  kAnybody
};

/// Whether a list of parameters (DDS Interoperability Wire Protocol 2.2, chapter 9.4.2.11) ends,
/// and the strings and sequences within its parameters are as long as they say: names, partitions,
/// user data, properties, tokens of security, representations, domains of shared memory, filters.
/// Of the descriptions of types only that there may be some; what they contain is not looked at.
bool is_parameter_list(RtpsBytes list, bool is_little_endian, ParameterSender sender);

/// Whether it is the content of a ParticipantGenericMessage (DDS Security 1.1, chapter 7.4.3.3),
/// with which participants that do not know each other yet authenticate themselves: all lengths and
/// counts lie within it. The library takes memory for what they say before it reads on.
bool is_handshake_message(RtpsBytes message, bool is_little_endian);

}  // namespace fleetloc
