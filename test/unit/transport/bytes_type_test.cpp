#include "shared/transport/bytes_type.hpp"

#include <gtest/gtest.h>

#include "shared/transport/instance_key.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

BytesType submap_type() {
  return BytesType(wire::SubmapPubSubType());
}

InstanceHandle_t instance_with(Bytes bytes) {
  InstanceHandle_t handle;
  EXPECT_TRUE(submap_type().getKey(&bytes, &handle, false));
  return handle;
}

TEST(BytesType, HasTheNameAndTheKeysOfTheGeneratedType) {
  EXPECT_STREQ(submap_type().getName(), "fleetloc::wire::Submap");
  wire::Submap sample;
  sample.robot("robot_17");
  InstanceHandle_t expected;
  ASSERT_TRUE(wire::SubmapPubSubType().getKey(&sample, &expected, false));
  EXPECT_EQ(instance_with(to_bytes<wire::SubmapPubSubType>(sample)), expected);
  EXPECT_FALSE(instance_with(numbered_submap(1, "robot_18").payload) == expected);
}

TEST(BytesType, MayHaveANameAlone) {
  BytesType type("sensor_msgs::msg::dds_::Imu_");
  EXPECT_STREQ(type.getName(), "sensor_msgs::msg::dds_::Imu_");
  EXPECT_FALSE(type.m_isGetKeyDefined);
}

TEST(BytesType, LetsBytesThroughAsTheyAre) {
  BytesType type = submap_type();
  Bytes bytes = numbered_submap(1).payload;
  SerializedPayload_t payload(type.getSerializedSizeProvider(&bytes)());
  ASSERT_TRUE(type.serialize(&bytes, &payload));
  Bytes received;
  ASSERT_TRUE(type.deserialize(&payload, &received));
  EXPECT_EQ(received, bytes);
}

TEST(BytesType, RefusesToSendWhatDoesNotFitOrHasNoEncapsulation) {
  BytesType type = submap_type();
  SerializedPayload_t payload(8);
  Bytes too_long(9);
  EXPECT_FALSE(type.serialize(&too_long, &payload));
  Bytes too_short(3);
  EXPECT_FALSE(type.serialize(&too_short, &payload));
}

TEST(BytesType, GivesAnInstanceToWhatHasNoKey) {
  EXPECT_EQ(instance_with({}), undecodable_instance());
  EXPECT_EQ(instance_with({0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0}), undecodable_instance())
      << "encoding";
  EXPECT_EQ(instance_with({0, 1, 0, 0, 8, 0, 0, 0}), undecodable_instance()) << "cut short";
}

}  // namespace
}  // namespace fleetloc
