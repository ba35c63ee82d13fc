#include "shared/wire/cdr.hpp"

#include <algorithm>
#include <cstring>

#include <gtest/gtest.h>
#include <idl/localizationPubSubTypes.h>
#include <idl/posePubSubTypes.h>
#include <idl/sessionPubSubTypes.h>
#include <idl/statusPubSubTypes.h>
#include <idl/submapPubSubTypes.h>

#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

/// Decodes `bytes` as DDS would, and expects the same bytes when DDS encodes the result.
template <typename PubSubType>
void expect_as_generated(const Bytes& bytes) {
  PubSubType type;
  typename PubSubType::type sample;
  eprosima::fastrtps::rtps::SerializedPayload_t received(static_cast<std::uint32_t>(bytes.size()));
  std::memcpy(received.data, bytes.data(), bytes.size());
  received.length = static_cast<std::uint32_t>(bytes.size());
  ASSERT_TRUE(type.deserialize(&received, &sample));
  eprosima::fastrtps::rtps::SerializedPayload_t sent(type.getSerializedSizeProvider(&sample)());
  ASSERT_TRUE(type.serialize(&sample, &sent));
  EXPECT_EQ(bytes, Bytes(sent.data, sent.data + sent.length));
}

TEST(Cdr, IsWhatTheGeneratedTypesWrite) {
  expect_as_generated<wire::SubmapPubSubType>(encode(some_submap(10, 80)));
  expect_as_generated<wire::SubmapPubSubType>(encode(some_submap(1, 0)));
  expect_as_generated<wire::RobotSessionPubSubType>(encode(some_session()));
  expect_as_generated<wire::LocalizerStatusPubSubType>(encode(some_localizer_status()));
  expect_as_generated<wire::RobotStatusPubSubType>(encode(some_robot_status()));
  expect_as_generated<wire::PoseEstimatePubSubType>(encode(some_pose_estimate()));
}

TEST(Cdr, RefusesTruncatedBytes) {
  const Bytes bytes = encode(some_submap());
  for (const std::size_t length : {std::size_t{0}, std::size_t{3}, bytes.size() - 1}) {
    const auto decoded = decode_submap(std::span(bytes).first(length));
    ASSERT_FALSE(decoded.has_value()) << length;
    EXPECT_EQ(decoded.error(), Malformed::kUndecodable);
  }
}

TEST(Cdr, RefusesBytesBehindTheSampleButPadding) {
  Bytes bytes = encode(some_submap());
  bytes.insert(bytes.end(), 3, 0);
  EXPECT_TRUE(decode_submap(bytes).has_value());
  bytes.push_back(0);
  EXPECT_FALSE(decode_submap(bytes).has_value());
}

TEST(Cdr, RefusesAnIdThatTheGeneratedCodeWouldCut) {
  const std::string cut = "robot-with-a-name-of-32-characte";
  Submap submap = some_submap();
  submap.robot = cut;
  Bytes bytes = encode(submap);
  ASSERT_EQ(std::string(bytes.begin() + 8, bytes.begin() + 40), cut);
  // Room for padding up to a multiple of four stands behind the terminating zero.
  bytes[4] += 2;
  bytes[40] = 'r';
  bytes[41] = 0;
  const auto decoded = decode_submap(bytes);
  ASSERT_FALSE(decoded.has_value());
  EXPECT_EQ(decoded.error(), Malformed::kInvalidId);
}

}  // namespace
}  // namespace fleetloc
