#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

namespace fleetloc {

/// Little endian plain CDR with its encapsulation, byte for byte what the generated PubSubType
/// writes.
template <typename T>
std::vector<std::uint8_t> to_cdr(const T& message) {
  using eprosima::fastcdr::Cdr;
  constexpr std::size_t kEncapsulation = 4;
  std::vector<std::uint8_t> bytes(T::getCdrSerializedSize(message) + kEncapsulation);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  bytes.resize(cdr.getSerializedDataLength());
  return bytes;
}

/// Calls `read(Cdr&)` behind the encapsulation, in either byte order. A count is never believed
/// beyond the bytes that are there, so memory is bounded by the size of what has arrived.
/// @return how many bytes were left; nothing if it could not be read
template <typename Read>
std::optional<std::size_t> read_cdr(std::span<const std::uint8_t> bytes, const Read& read) {
  using eprosima::fastcdr::Cdr;
  try {
    // The buffer's interface is for writing, too; nothing is written here.
    auto* begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
    eprosima::fastcdr::FastBuffer buffer(begin, bytes.size());
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    read(cdr);
    return bytes.size() - cdr.getSerializedDataLength();
  } catch (const std::exception&) {  // fastcdr's, and lack of memory
    return std::nullopt;
  }
}

/// A message whose values are still to be checked; nothing if `bytes` are not one.
template <typename T>
std::optional<T> from_cdr(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kMaxPadding = 3;  // other vendors fill up to a multiple of four
  std::optional<T> message(std::in_place);
  const auto left = read_cdr(bytes, [&](auto& cdr) { message->deserialize(cdr); });
  if (!left || *left > kMaxPadding) return std::nullopt;
  return message;
}

}  // namespace fleetloc
