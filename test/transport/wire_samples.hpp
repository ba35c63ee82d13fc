#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

#include <idl/localizationPubSubTypes.h>
#include <idl/sessionPubSubTypes.h>
#include <idl/submapPubSubTypes.h>

#include "shared/link/channel.hpp"

namespace fleetloc {

/// As the generated type support does it.
template <typename PubSubType>
Bytes to_bytes(typename PubSubType::type sample) {
  PubSubType type;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(type.getSerializedSizeProvider(&sample)());
  if (!type.serialize(&sample, &payload)) throw std::runtime_error("cannot be serialized");
  return {payload.data, payload.data + payload.length};
}

template <typename PubSubType>
typename PubSubType::type from_bytes(Bytes bytes) {
  const auto size = static_cast<std::uint32_t>(bytes.size());
  eprosima::fastrtps::rtps::SerializedPayload_t payload(size);
  payload.length = size;
  std::copy(bytes.begin(), bytes.end(), payload.data);
  typename PubSubType::type sample;
  if (!PubSubType().deserialize(&payload, &sample)) throw std::runtime_error("is malformed");
  return sample;
}

/// @param rows  for a size: a row more is 2 bytes more
inline Message numbered_submap(std::uint32_t number,
                               const std::string& robot = "robot_1",
                               std::size_t rows = 0) {
  wire::Submap submap;
  submap.robot(robot);
  submap.number(number);
  submap.observation_left_u().resize(rows);
  return {.topic = Topic::kSubmap, .payload = to_bytes<wire::SubmapPubSubType>(submap)};
}

inline Message session_of(const std::string& robot) {
  wire::RobotSession session;
  session.robot(robot);
  return {.topic = Topic::kSession, .payload = to_bytes<wire::RobotSessionPubSubType>(session)};
}

inline Message answer_to(std::uint32_t number, wire::LocalizationStatus status) {
  wire::LocalizationResult result;
  result.robot("robot_1");
  result.acknowledged_base(number);
  result.status(status);
  return {.topic = Topic::kLocalization,
          .payload = to_bytes<wire::LocalizationResultPubSubType>(result)};
}

inline std::uint32_t number_of(const Message& submap) {
  return from_bytes<wire::SubmapPubSubType>(submap.payload).number();
}

}  // namespace fleetloc
