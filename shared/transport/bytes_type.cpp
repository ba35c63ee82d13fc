#include "shared/transport/bytes_type.hpp"

#include <algorithm>

#include "shared/link/channel.hpp"
#include "shared/transport/instance_key.hpp"

namespace fleetloc {

BytesType::BytesType(const TopicDataType& generated) {
  setName(generated.getName());
  m_typeSize = generated.m_typeSize;
  m_isGetKeyDefined = generated.m_isGetKeyDefined;
  // Other vendors refuse the type descriptions of this version.
  auto_fill_type_information(false);
  auto_fill_type_object(false);
}

BytesType::BytesType(const std::string& name) {
  setName(name.c_str());
  m_typeSize = kEncapsulationBytes;
  auto_fill_type_information(false);
  auto_fill_type_object(false);
}

bool BytesType::serialize(void* sample, Payload* payload) {
  const Bytes& bytes = *static_cast<const Bytes*>(sample);
  if (bytes.size() < kEncapsulationBytes || bytes.size() > payload->max_size) return false;
  payload->length = static_cast<std::uint32_t>(bytes.size());
  payload->encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
  std::ranges::copy(bytes, payload->data);
  return true;
}

bool BytesType::deserialize(Payload* payload, void* sample) {
  static_cast<Bytes*>(sample)->assign(payload->data, payload->data + payload->length);
  return true;
}

std::function<std::uint32_t()> BytesType::getSerializedSizeProvider(void* sample) {
  const auto size = static_cast<std::uint32_t>(static_cast<const Bytes*>(sample)->size());
  return [size] { return size; };
}

bool BytesType::getKey(void* sample, Handle* handle, bool /*force_md5*/) {  // it is always MD5
  const auto key = key_of(*static_cast<const Bytes*>(sample));
  *handle = key ? instance_of(*key) : undecodable_instance();
  return true;
}

void* BytesType::createData() {
  return new Bytes();
}

void BytesType::deleteData(void* sample) {
  delete static_cast<Bytes*>(sample);
}

}  // namespace fleetloc
