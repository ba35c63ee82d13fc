#include "shared/transport/bytes_type.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

using Type = BytesType<wire::SubmapPubSubType>;

InstanceHandle_t key_of(Bytes bytes) {
  InstanceHandle_t handle;
  EXPECT_TRUE(Type().getKey(&bytes, &handle, false));
  return handle;
}

TEST(BytesType, HasTheNameAndTheKeysOfTheGeneratedType) {
  EXPECT_STREQ(Type().getName(), "fleetloc::wire::Submap");
  wire::Submap sample;
  sample.robot("robot_17");
  InstanceHandle_t expected;
  ASSERT_TRUE(wire::SubmapPubSubType().getKey(&sample, &expected, false));
  EXPECT_EQ(key_of(to_bytes<wire::SubmapPubSubType>(sample)), expected);
  EXPECT_FALSE(key_of(numbered_submap(1, "robot_18").payload) == expected);
}

TEST(BytesType, LetsBytesThroughAsTheyAre) {
  Type type;
  Bytes bytes = numbered_submap(1).payload;
  SerializedPayload_t payload(type.getSerializedSizeProvider(&bytes)());
  ASSERT_TRUE(type.serialize(&bytes, &payload));
  Bytes received;
  ASSERT_TRUE(type.deserialize(&payload, &received));
  EXPECT_EQ(received, bytes);
}

TEST(BytesType, RefusesToSendWhatDoesNotFitOrHasNoEncapsulation) {
  Type type;
  SerializedPayload_t payload(8);
  Bytes too_long(9);
  EXPECT_FALSE(type.serialize(&too_long, &payload));
  Bytes too_short(3);
  EXPECT_FALSE(type.serialize(&too_short, &payload));
}

TEST(BytesType, GivesAnInstanceToWhatCannotBeDecoded) {
  EXPECT_EQ(key_of({}), undecodable_instance());
  EXPECT_EQ(key_of({0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0}), undecodable_instance()) << "encoding";
  EXPECT_EQ(key_of({0, 1, 0, 0, 8, 0, 0, 0}), undecodable_instance()) << "cut short";
}

TEST(BytesType, SurvivesRandomBytes) {
  std::mt19937 random(1);
  for (int round = 0; round < 10'000; ++round) {
    Bytes bytes(random() % 256 + 4);
    std::ranges::generate(bytes, [&] { return static_cast<std::uint8_t>(random()); });
    bytes[0] = 0;  // plain CDR, so that the decoder looks further
    bytes[1] = 1;
    if (round % 2 == 0) {  // the first string shorter than 256
      for (std::size_t i = 5; i < std::min<std::size_t>(8, bytes.size()); ++i) bytes[i] = 0;
    }
    key_of(bytes);
  }
}

TEST(BytesType, SurvivesSamplesWithFlippedBitsAndCutEnds) {
  std::mt19937 random(2);
  const Bytes sample = numbered_submap(1, "robot_1", 20).payload;
  for (int round = 0; round < 10'000; ++round) {
    Bytes bytes(sample.begin(), sample.end() - static_cast<long>(random() % sample.size()));
    bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    key_of(bytes);
  }
}

}  // namespace
}  // namespace fleetloc
