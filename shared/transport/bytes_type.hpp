#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <functional>

#include <fastdds/dds/topic/TypeSupport.hpp>

#include "shared/link/channel.hpp"

namespace fleetloc {

/// The instance of samples whose key cannot be read. They need one: Fast DDS would keep a sample
/// without an instance in the reader's history, where nothing ever takes it, until that is full.
eprosima::fastrtps::rtps::InstanceHandle_t undecodable_instance();

/// A type of idl/ whose samples are already serialized: Bytes go through as they are, under the
/// generated type's name and with its keys. PubSubType is the type support that fastddsgen emits.
/// Used by many threads at once.
template <typename PubSubType>
class BytesType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  using Handle = eprosima::fastrtps::rtps::InstanceHandle_t;

  BytesType() {
    PubSubType generated;
    setName(generated.getName());
    m_typeSize = generated.m_typeSize;
    m_isGetKeyDefined = generated.m_isGetKeyDefined;
    // Other vendors refuse the type descriptions of this version.
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }

  bool serialize(void* sample, Payload* payload) override {
    const Bytes& bytes = *static_cast<const Bytes*>(sample);
    if (bytes.size() < kEncapsulation || bytes.size() > payload->max_size) return false;
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
    std::ranges::copy(bytes, payload->data);
    return true;
  }

  bool deserialize(Payload* payload, void* sample) override {
    static_cast<Bytes*>(sample)->assign(payload->data, payload->data + payload->length);
    return true;
  }

  std::function<std::uint32_t()> getSerializedSizeProvider(void* sample) override {
    const auto size = static_cast<std::uint32_t>(static_cast<const Bytes*>(sample)->size());
    return [size] { return size; };
  }

  /// Never fails: what cannot be decoded belongs to undecodable_instance().
  bool getKey(void* sample, Handle* handle, bool force_md5) override {
    if (!generated_key(*static_cast<Bytes*>(sample), handle, force_md5)) {
      *handle = undecodable_instance();
    }
    return true;
  }

  void* createData() override { return new Bytes(); }
  void deleteData(void* sample) override { delete static_cast<Bytes*>(sample); }

 private:
  static constexpr std::size_t kEncapsulation = 4;  // bytes

  static bool generated_key(Bytes& bytes, Handle* handle, bool force_md5) {
    PubSubType generated;  // has a buffer for the key: one for each call, so for each thread
    typename PubSubType::type decoded;
    Payload payload;  // borrows the bytes
    payload.data = bytes.data();
    payload.length = payload.max_size = static_cast<std::uint32_t>(bytes.size());
    bool valid = false;
    try {
      // Some of the decoder's exceptions escape from the generated code; they would end the
      // program.
      valid = bytes.size() >= kEncapsulation && generated.deserialize(&payload, &decoded) &&
              generated.getKey(&decoded, handle, force_md5);
    } catch (const std::exception&) {  // not valid
    }
    payload.data = nullptr;  // not its own
    return valid;
  }
};

}  // namespace fleetloc
