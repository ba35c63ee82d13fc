#include "shared/transport/instance_key.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

#include <fastrtps/utils/md5.h>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxKey = 32;  // characters
constexpr std::size_t kLengthBytes = 4;
constexpr std::uint8_t kCdrLittleEndian = 1;
constexpr std::uint8_t kParameterList = 2;  // not ours, but Fast CDR reads on

// Of a string, with its terminating zero.
std::size_t length_at(std::span<const std::uint8_t> field, bool is_little_endian) {
  std::size_t length = 0;
  for (std::size_t i = 0; i < kLengthBytes; ++i) {
    length = length << 8U | field[is_little_endian ? kLengthBytes - 1 - i : i];
  }
  return length;
}

}  // namespace

std::string_view name(KeyDefect defect) {
  switch (defect) {
    case KeyDefect::kEncapsulation:
      return "encapsulation";
    case KeyDefect::kCutShort:
      return "cut_short";
    case KeyDefect::kForeignWriter:
      return "foreign_writer";
  }
  return "";
}

expected<std::string_view, KeyDefect> key_of(std::span<const std::uint8_t> sample) {
  if (sample.size() < kEncapsulationBytes + kLengthBytes) return unexpected(KeyDefect::kCutShort);
  const std::uint8_t kind = sample[1];
  if (sample[0] != 0 || (kind & ~(kCdrLittleEndian | kParameterList)) != 0) {
    return unexpected(KeyDefect::kEncapsulation);
  }
  const auto field = sample.subspan(kEncapsulationBytes);
  const std::size_t length = length_at(field, (kind & kCdrLittleEndian) != 0);
  const auto characters = field.subspan(kLengthBytes);
  if (length > characters.size()) return unexpected(KeyDefect::kCutShort);
  const auto kept = characters.first(std::min(length, kMaxKey));
  const auto end = std::ranges::find(kept, std::uint8_t{0});
  return std::string_view(reinterpret_cast<const char*>(kept.data()),
                          static_cast<std::size_t>(end - kept.begin()));
}

eprosima::fastrtps::rtps::InstanceHandle_t instance_of(std::string_view key) {
  assert(key.size() <= kMaxKey);
  std::array<std::uint8_t, kLengthBytes + kMaxKey + 1> serialized{};
  serialized[kLengthBytes - 1] = static_cast<std::uint8_t>(key.size() + 1);  // the zero counts
  std::ranges::copy(key, serialized.begin() + kLengthBytes);
  MD5 md5;
  md5.update(serialized.data(), static_cast<MD5::size_type>(kLengthBytes + key.size() + 1));
  md5.finalize();
  eprosima::fastrtps::rtps::InstanceHandle_t instance;
  for (std::uint8_t i = 0; i < 16; ++i) instance.value[i] = md5.digest[i];
  return instance;
}

eprosima::fastrtps::rtps::InstanceHandle_t undecodable_instance() {
  eprosima::fastrtps::rtps::InstanceHandle_t instance;
  for (std::uint8_t i = 0; i < 16; ++i) instance.value[i] = 0xff;
  return instance;
}

}  // namespace fleetloc
