#include "shared/transport/workarounds/parameter_check.hpp"

#include <algorithm>
#include <cstddef>

namespace fleetloc {
namespace {

// Its tables 9.13 and 9.14; DDS Security 1.1, tables 10 and 14; DDS XTypes 1.3; Fast DDS.
enum Parameter : std::uint16_t {
  kEndOfList = 0x0001,
  kTopicName = 0x0005,
  kTypeName = 0x0007,
  kPartitionNames = 0x0029,
  kUserOctets = 0x002c,
  kGroupOctets = 0x002d,
  kTopicOctets = 0x002e,
  kContentFilter = 0x0035,
  kPropertyList = 0x0059,
  kEntityName = 0x0062,
  kTypeIdentifier = 0x0069,
  kTypeObject = 0x0072,
  kDataRepresentation = 0x0073,
  kTypeInformation = 0x0075,
  kIdentityToken = 0x1001,
  kPermissionsToken = 0x1002,
  kIdentityStatusToken = 0x1006,
  kSharedMemoryDomains = 0x8006,
};

constexpr std::size_t kMaxFilterExpression = 256;  // longer ones take the library's parser too far

/// The content of a parameter; each function reads on and returns false behind its end.
class Content {
 public:
  Content(RtpsBytes bytes, bool is_little_endian)
      : fields_(bytes, is_little_endian), left_(bytes.size()) {}

  bool octets() {
    const std::size_t size = number();
    if (!has(size)) return false;
    take_padded(size);
    return true;
  }

  bool string(std::size_t max = SIZE_MAX) {
    const std::size_t size = number();
    if (!has(size) || size > max) return false;
    const RtpsBytes text = take_padded(size);
    return size == 0 || text[size - 1] == 0;
  }

  template <typename Element>
  bool sequence(const Element& element) {
    constexpr std::size_t kLeastBytes = 4;
    const std::size_t count = number();
    if (!is_complete_ || count > left_ / kLeastBytes) return false;
    for (std::size_t i = 0; i < count; ++i) {
      if (!element()) return false;
    }
    return true;
  }

  bool numbers_of(std::size_t bytes) {
    const std::size_t count = number();
    return is_complete_ && count <= left_ / bytes;
  }

  bool token() {
    return string() && sequence([this] { return string() && string(); }) &&
           sequence([this] { return string() && octets(); });
  }

  bool filter() {
    return string() && string() && string() && string(kMaxFilterExpression) &&
           sequence([this] { return string(); });
  }

 private:
  [[nodiscard]] bool has(std::size_t size) const { return is_complete_ && size <= left_; }

  std::size_t number() {
    is_complete_ = is_complete_ && left_ >= 4;
    if (!is_complete_) return 0;
    left_ -= 4;
    return fields_.u32();
  }

  // What fills up the last four bytes may be missing at the end.
  RtpsBytes take_padded(std::size_t size) {
    const RtpsBytes taken = fields_.skip(size);
    const std::size_t padding = std::min((4 - size % 4) % 4, left_ - size);
    fields_.skip(padding);
    left_ -= size + padding;
    return taken;
  }

  RtpsFields fields_;
  std::size_t left_;
  bool is_complete_ = true;
};

bool is_content(std::uint16_t id, Content content, ParameterSender sender) {
  switch (id) {
    case kTopicName:
    case kTypeName:
    case kEntityName:
      return content.string();
    case kUserOctets:
    case kGroupOctets:
    case kTopicOctets:
      return content.octets();
    case kPartitionNames:
      return content.sequence([&] { return content.string(); });
    case kPropertyList:
      return content.sequence([&] { return content.string() && content.string(); });
    case kIdentityToken:
    case kPermissionsToken:
    case kIdentityStatusToken:
      return content.token();
    case kDataRepresentation:
      return content.numbers_of(2);
    case kSharedMemoryDomains:
      return content.numbers_of(8);
    case kContentFilter:
      return sender == ParameterSender::kAnybody && content.filter();
    case kTypeIdentifier:
    case kTypeObject:
    case kTypeInformation:
      return sender == ParameterSender::kAnybody;
    default:
      return true;  // of fixed size, which the library checks, or not known to it
  }
}

}  // namespace

bool is_parameter_list(RtpsBytes list, bool is_little_endian, ParameterSender sender) {
  RtpsFields fields(list, is_little_endian);
  while (fields.is_complete()) {
    const std::uint16_t id = fields.u16();
    const std::uint16_t length = fields.u16();
    if (id == kEndOfList) return fields.is_complete();
    if (length % 4 != 0) return false;
    const RtpsBytes content = fields.skip(length);
    if (!fields.is_complete() || !is_content(id, Content(content, is_little_endian), sender)) {
      return false;
    }
  }
  return false;
}

bool is_handshake_message(RtpsBytes message, bool is_little_endian) {
  constexpr std::size_t kIdentities = 96;  // of message, related one, destination, source
  if (message.size() < kIdentities) return false;
  Content content(message.subspan(kIdentities), is_little_endian);
  return content.string() && content.sequence([&] { return content.token(); });
}

}  // namespace fleetloc
