#pragma once

#include <cstdint>
#include <exception>
#include <span>
#include <string>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include "shared/core/ids.hpp"
#include "shared/link/channel.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {

/// Little endian CDR with its encapsulation, byte for byte what the generated PubSubType writes.
template <typename T>
Bytes to_cdr(const T& sample) {
  using eprosima::fastcdr::Cdr;
  constexpr std::size_t kEncapsulation = 4;
  Bytes bytes(T::getCdrSerializedSize(sample) + kEncapsulation);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  sample.serialize(cdr);
  bytes.resize(cdr.getSerializedDataLength());
  return bytes;
}

/// A sample whose ids are valid, and nothing else: its other fields are still to be checked.
/// @param ids  how many strings the type begins with. They are read in full first, because the
///             generated code would cut one that is too long, and make it another robot's.
template <typename T>
Decoded<T> from_cdr(std::span<const std::uint8_t> bytes, int ids) {
  using eprosima::fastcdr::Cdr;
  constexpr std::size_t kMaxPadding = 3;  // other vendors fill up to a multiple of four
  try {
    // The buffer's interface is for writing, too; nothing is written here.
    auto* begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
    eprosima::fastcdr::FastBuffer buffer(begin, bytes.size());
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    Cdr::state start = cdr.getState();
    for (int i = 0; i < ids; ++i) {
      std::string id;
      cdr >> id;
      if (!is_valid_id(id)) return unexpected(Malformed::kInvalidId);
    }
    cdr.setState(start);
    T sample;
    sample.deserialize(cdr);
    if (bytes.size() - cdr.getSerializedDataLength() > kMaxPadding)
      return unexpected(Malformed::kUndecodable);
    return sample;
  } catch (const std::exception&) {  // fastcdr's, and lack of memory
    return unexpected(Malformed::kUndecodable);
  }
}

/// A sample whose ids are valid and that passes `check`.
template <typename T>
Decoded<T> valid_from_cdr(std::span<const std::uint8_t> bytes,
                          int ids,
                          Validity (*check)(const T&)) {
  Decoded<T> sample = from_cdr<T>(bytes, ids);
  if (!sample) return sample;
  if (const Validity valid = check(*sample); !valid) return unexpected(valid.error());
  return sample;
}

}  // namespace fleetloc
