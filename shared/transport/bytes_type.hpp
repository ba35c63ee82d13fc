#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <fastdds/dds/topic/TopicDataType.hpp>

namespace fleetloc {

/// A type of idl/ whose samples are already serialized: Bytes go through as they are, under the
/// generated type's name and with its keys; or a type without a key. Used by many threads at once.
class BytesType final : public eprosima::fastdds::dds::TopicDataType {
 public:
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  using Handle = eprosima::fastrtps::rtps::InstanceHandle_t;

  /// @param generated  the type support that fastddsgen emits
  explicit BytesType(const TopicDataType& generated);

  /// Without a key. Its samples have any size, so QoS profiles must not preallocate them.
  explicit BytesType(const std::string& name);

  bool serialize(void* sample, Payload* payload) override;
  bool deserialize(Payload* payload, void* sample) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* sample) override;

  /// Reads no more of the sample than its key: Fast DDS asks for it once when it is sent and once
  /// when it arrives. Never fails: without a key it belongs to undecodable_instance().
  bool getKey(void* sample, Handle* handle, bool force_md5) override;

  void* createData() override;
  void deleteData(void* sample) override;
};

}  // namespace fleetloc
