#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include <fastdds/rtps/common/InstanceHandle.h>

#include "shared/core/expected.hpp"

namespace fleetloc {

/// In front of every serialized sample.
inline constexpr std::size_t kEncapsulationBytes = 4;

/// Why the key of a sample cannot be read.
enum class KeyDefect {
  kEncapsulation,  ///< not that of CDR
  kCutShort,       ///< the sample ends within its key
  kForeignWriter   ///< its key is another member's than the one that wrote it, see FleetKeys
};
std::string_view name(KeyDefect defect);

/// The key of a serialized sample: the string that every type of idl/ begins with, and no other
/// field is a key. What follows it is not looked at.
/// @param sample  CDR with its four bytes of encapsulation
/// @return a part of `sample`: up to 32 characters, the bound in the IDL; Fast DDS cuts longer ones
expected<std::string_view, KeyDefect> key_of(std::span<const std::uint8_t> sample);

/// The instance with this key, as the generated types compute it: MD5 over the key in big endian
/// CDR (OMG, DDS Interoperability Wire Protocol 2.2, chapter 9.6.3.8), since it may have more than
/// 16 bytes.
/// @param key  at most 32 characters
eprosima::fastrtps::rtps::InstanceHandle_t instance_of(std::string_view key);

/// The instance of samples whose key cannot be read. They need one: Fast DDS would keep a sample
/// without an instance in the reader's history, where nothing ever takes it, until that is full.
eprosima::fastrtps::rtps::InstanceHandle_t undecodable_instance();

}  // namespace fleetloc
