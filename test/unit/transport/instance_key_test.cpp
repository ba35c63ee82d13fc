#include "shared/transport/instance_key.hpp"

#include <algorithm>
#include <optional>
#include <random>
#include <string>

#include <fastcdr/Cdr.h>
#include <gtest/gtest.h>
#include <idl/compact_submapPubSubTypes.h>
#include <idl/posePubSubTypes.h>
#include <idl/statusPubSubTypes.h>

#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

/// As the generated code does it: the whole sample is decoded, then its key encoded.
template <typename PubSubType>
std::optional<InstanceHandle_t> generated_key(const Bytes& bytes) {
  PubSubType type;
  typename PubSubType::type decoded;
  SerializedPayload_t payload(static_cast<std::uint32_t>(bytes.size()));
  payload.length = payload.max_size;
  std::ranges::copy(bytes, payload.data);
  InstanceHandle_t handle;
  try {
    if (!type.deserialize(&payload, &decoded)) return std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;
  }
  return type.getKey(&decoded, &handle, false) ? std::optional(handle) : std::nullopt;
}

std::optional<InstanceHandle_t> key_alone(const Bytes& bytes) {
  const auto key = key_of(bytes);
  return key ? std::optional(instance_of(*key)) : std::nullopt;
}

Bytes big_endian(const auto& sample) {
  using eprosima::fastcdr::Cdr;
  Bytes bytes(4096);
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(bytes.data()), bytes.size());
  Cdr cdr(buffer, Cdr::BIG_ENDIANNESS, Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  sample.serialize(cdr);
  bytes.resize(cdr.getSerializedDataLength());
  return bytes;
}

template <typename PubSubType>
class InstanceKey : public testing::Test {
 protected:
  static typename PubSubType::type sample_of(const std::string& key) {
    typename PubSubType::type sample;
    if constexpr (requires { sample.robot(); }) {
      sample.robot(key);
    } else {
      sample.localizer(key);
    }
    return sample;
  }

  // What can be decoded in full has the same key.
  static void expect_the_same(const Bytes& bytes) {
    const auto expected = generated_key<PubSubType>(bytes);
    if (expected) {
      ASSERT_EQ(key_alone(bytes), expected) << testing::PrintToString(bytes);
    }
  }
};

using Types = testing::Types<wire::RobotSessionPubSubType,
                             wire::SubmapPubSubType,
                             wire::LocalizationResultPubSubType,
                             wire::CompactSubmapPubSubType,
                             wire::RobotStatusPubSubType,
                             wire::LocalizerStatusPubSubType,
                             wire::PoseEstimatePubSubType>;
TYPED_TEST_SUITE(InstanceKey, Types);

TYPED_TEST(InstanceKey, IsThatOfTheGeneratedTypeInBothByteOrders) {
  const std::string longest(32, 'x');
  for (const std::string& key : {std::string(), std::string("a"), std::string("r2"), longest}) {
    const auto sample = this->sample_of(key);
    for (const Bytes& bytes : {to_bytes<TypeParam>(sample), big_endian(sample)}) {
      const auto expected = generated_key<TypeParam>(bytes);
      ASSERT_TRUE(expected);
      EXPECT_EQ(key_alone(bytes), expected) << key;
      EXPECT_EQ(key_of(bytes), key);
    }
  }
  TypeParam generated;
  EXPECT_TRUE(generated.m_isGetKeyDefined);
}

TYPED_TEST(InstanceKey, IsThatOfTheGeneratedTypeWhateverElseIsWrong) {
  std::mt19937 random(1);
  const Bytes sample = to_bytes<TypeParam>(this->sample_of("robot_with_a_name_of_32_characte"));
  for (int round = 0; round < 3000; ++round) {
    Bytes bytes = sample;
    for (auto changes = random() % 3; changes > 0; --changes) {
      const auto within =
          random() % 2 == 0 ? std::min<std::size_t>(bytes.size(), 44) : bytes.size();
      bytes[random() % within] ^= static_cast<std::uint8_t>(1U << random() % 8);
    }
    if (random() % 4 == 0) bytes.resize(random() % (bytes.size() + 1));
    this->expect_the_same(bytes);
  }
}

// 32 characters are kept, the bound in the IDL; a sender in another language may send more.
TYPED_TEST(InstanceKey, IsCutWhereTheGeneratedTypeCutsIt) {
  for (const std::uint8_t length : Bytes{0, 1, 31, 32, 33, 34, 60}) {
    for (const bool is_terminated : {true, false}) {
      Bytes bytes{0, 1, 0, 0, length, 0, 0, 0};
      bytes.resize(bytes.size() + length, 'x');
      if (is_terminated && length > 0) bytes.back() = 0;
      bytes.resize(bytes.size() + 4096);  // the other fields, all zero
      ASSERT_TRUE(generated_key<TypeParam>(bytes)) << int{length};
      this->expect_the_same(bytes);
      if (length > 8) {
        bytes[8 + 5] = 0;
        this->expect_the_same(bytes);
        EXPECT_EQ(key_of(bytes), "xxxxx");
      }
    }
  }
}

TEST(KeyOf, NamesWhatIsWrong) {
  const auto defect = [](const Bytes& bytes) { return std::string(name(key_of(bytes).error())); };
  EXPECT_EQ(defect({}), "cut_short");
  EXPECT_EQ(defect({0, 1, 0, 0, 8, 0, 0}), "cut_short") << "in its length";
  EXPECT_EQ(defect({0, 1, 0, 0, 3, 0, 0, 0, 'r', '1'}), "cut_short") << "in its characters";
  EXPECT_EQ(defect({0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 'r', '1'}), "cut_short");
  EXPECT_EQ(defect({1, 1, 0, 0, 1, 0, 0, 0, 0}), "encapsulation");
  EXPECT_EQ(defect({0, 4, 0, 0, 1, 0, 0, 0, 0}), "encapsulation");
}

TEST(KeyOf, NeedsNothingBehindTheKey) {
  EXPECT_EQ(key_of(Bytes{0, 1, 0, 0, 3, 0, 0, 0, 'r', '1', 0}), "r1");
  EXPECT_EQ(key_of(Bytes{0, 0, 0, 0, 0, 0, 0, 3, 'r', '1', 0}), "r1") << "big endian";
  EXPECT_EQ(key_of(Bytes{0, 1, 0, 0, 0, 0, 0, 0}), "");
}

TEST(KeyOf, SurvivesRandomBytes) {
  std::mt19937 random(1);
  for (int round = 0; round < 100'000; ++round) {
    Bytes bytes(random() % 64);
    std::ranges::generate(bytes, [&] { return static_cast<std::uint8_t>(random()); });
    if (bytes.size() >= 8 && round % 4 != 0) {  // so that more of them have a key
      std::ranges::copy(Bytes{0, 1}, bytes.begin());
      std::ranges::fill(bytes.begin() + 5, bytes.begin() + 8, std::uint8_t{0});
    }
    const auto key = key_of(bytes);
    if (!key) continue;
    EXPECT_LE(key->size(), 32);
    EXPECT_LE(key->size() + 8, bytes.size());
    EXPECT_FALSE(instance_of(*key) == undecodable_instance());
  }
}

}  // namespace
}  // namespace fleetloc
