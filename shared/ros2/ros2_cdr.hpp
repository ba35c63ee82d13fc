#pragma once

#include <cstdint>
#include <exception>
#include <span>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include "shared/link/channel.hpp"
#include "shared/ros2/ros2_refusal.hpp"

namespace fleetloc {

/// Little endian plain CDR with its encapsulation, as ROS 2 sends it.
template <typename T>
Bytes to_ros2_cdr(const T& message) {
  using eprosima::fastcdr::Cdr;
  constexpr std::size_t kEncapsulation = 4;
  Bytes bytes(T::getCdrSerializedSize(message) + kEncapsulation);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  Cdr cdr(buffer, Cdr::LITTLE_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  bytes.resize(cdr.getSerializedDataLength());
  return bytes;
}

/// A message of either byte order whose values are still to be checked. A count is never believed
/// beyond the bytes that are there, so memory is bounded by the size of what has arrived.
template <typename T>
Ros2Decoded<T> from_ros2_cdr(std::span<const std::uint8_t> bytes) {
  using eprosima::fastcdr::Cdr;
  constexpr std::size_t kEncapsulation = 4;
  constexpr std::size_t kMaxPadding = 3;  // other vendors fill up to a multiple of four
  const bool is_plain_cdr = bytes.size() >= kEncapsulation && bytes[0] == 0 && bytes[1] <= 1;
  if (!is_plain_cdr) return unexpected(Ros2Refusal::kUndecodable);
  try {
    // The buffer's interface is for writing, too; nothing is written here.
    auto* begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
    eprosima::fastcdr::FastBuffer buffer(begin, bytes.size());
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    T message;
    message.deserialize(cdr);
    if (bytes.size() - cdr.getSerializedDataLength() > kMaxPadding)
      return unexpected(Ros2Refusal::kUndecodable);
    return message;
  } catch (const std::exception&) {  // fastcdr's, and lack of memory
    return unexpected(Ros2Refusal::kUndecodable);
  }
}

}  // namespace fleetloc
