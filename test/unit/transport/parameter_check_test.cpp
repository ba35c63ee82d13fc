#include "shared/transport/workarounds/parameter_check.hpp"

#include <initializer_list>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

constexpr std::uint32_t kHuge = 0xffffffff;

ByteWriter& add_text(ByteWriter& content, const std::string& text) {
  content.u32(static_cast<std::uint32_t>(text.size() + 1));
  content.bytes({text.begin(), text.end()});
  return content.zeros(4 - text.size() % 4);
}

Bytes texts(const std::vector<std::string>& all) {
  ByteWriter content;
  for (const std::string& text : all) add_text(content, text);
  return content.written();
}

Bytes counted(std::uint32_t count, const Bytes& elements) {
  return ByteWriter().u32(count).bytes(elements).written();
}

bool is_taken(std::uint16_t id,
              const Bytes& content,
              ParameterSender sender = ParameterSender::kFastDds) {
  const Bytes list = ByteWriter()
                         .u16(0x0015)  // something harmless before it
                         .u16(4)
                         .zeros(4)
                         .u16(id)
                         .u16(content.size())
                         .bytes(content)
                         .u16(1)
                         .u16(0)
                         .written();
  return is_parameter_list(list, true, sender);
}

TEST(ParameterCheck, KnowsNames) {
  for (const std::uint16_t id : std::initializer_list<std::uint16_t>{0x0005, 0x0007, 0x0062}) {
    EXPECT_TRUE(is_taken(id, texts({"fleetloc/2/submap"})));
    EXPECT_TRUE(is_taken(id, texts({""})));
    EXPECT_FALSE(is_taken(id, counted(kHuge, {'a', 0, 0, 0})));
    EXPECT_FALSE(is_taken(id, counted(5, {'a', 0, 0, 0})));
    EXPECT_FALSE(is_taken(id, counted(4, {'a', 'b', 'c', 'd'}))) << "it does not end";
    EXPECT_FALSE(is_taken(id, {}));
  }
}

TEST(ParameterCheck, KnowsUserData) {
  for (const std::uint16_t id : std::initializer_list<std::uint16_t>{0x002c, 0x002d, 0x002e}) {
    EXPECT_TRUE(is_taken(id, counted(3, {1, 2, 3, 0})));
    EXPECT_TRUE(is_taken(id, counted(0, {})));
    EXPECT_FALSE(is_taken(id, counted(5, {1, 2, 3, 4})));
    EXPECT_FALSE(is_taken(id, counted(kHuge, {1, 2, 3, 4})));
  }
}

TEST(ParameterCheck, KnowsPartitionsAndProperties) {
  EXPECT_TRUE(is_taken(0x0029, counted(2, texts({"hall", "b"}))));
  EXPECT_FALSE(is_taken(0x0029, counted(3, texts({"hall", "b"}))));
  EXPECT_FALSE(is_taken(0x0029, counted(kHuge, texts({"hall"}))));
  EXPECT_FALSE(is_taken(0x0029, counted(1, counted(kHuge, {'a', 0, 0, 0}))));
  EXPECT_TRUE(is_taken(0x0059, counted(1, texts({"PARTICIPANT_TYPE", "CLIENT"}))));
  EXPECT_FALSE(is_taken(0x0059, counted(1, texts({"PARTICIPANT_TYPE"}))));
  EXPECT_FALSE(is_taken(0x0059, counted(kHuge, texts({"PARTICIPANT_TYPE", "CLIENT"}))));
}

// CVE-2024-30258, CVE-2024-30259, CVE-2025-62599, CVE-2025-62600, CVE-2025-62602.
TEST(ParameterCheck, KnowsTokensOfSecurity) {
  const auto token = [](std::uint32_t properties, std::uint32_t binary, std::uint32_t octets) {
    ByteWriter content;
    add_text(content, "DDS:Auth:PKI-DH:1.0");
    content.u32(properties);
    add_text(add_text(content, "dds.cert.algo"), "RSA-2048");
    content.u32(binary);
    add_text(content, "hash").u32(octets).zeros(4);
    return content.written();
  };
  for (const std::uint16_t id : std::initializer_list<std::uint16_t>{0x1001, 0x1002, 0x1006}) {
    EXPECT_TRUE(is_taken(id, token(1, 1, 3)));
    EXPECT_FALSE(is_taken(id, token(kHuge, 1, 3)));
    EXPECT_FALSE(is_taken(id, token(0x10000000, 1, 3))) << "sixteen times that is 0";
    EXPECT_FALSE(is_taken(id, token(1, kHuge, 3)));
    EXPECT_FALSE(is_taken(id, token(1, 1, kHuge)));
    EXPECT_FALSE(is_taken(id, token(1, 1, 0xfffffffc)));
  }
}

// CVE-2026-49861: four billion times pushed back.
TEST(ParameterCheck, KnowsRepresentationsAndDomainsOfSharedMemory) {
  EXPECT_TRUE(is_taken(0x0073, counted(2, {0, 0, 2, 0})));
  EXPECT_FALSE(is_taken(0x0073, counted(3, {0, 0, 2, 0})));
  EXPECT_FALSE(is_taken(0x0073, counted(kHuge, {0, 0, 2, 0})));
  EXPECT_TRUE(is_taken(0x8006, counted(1, Bytes(8))));
  EXPECT_FALSE(is_taken(0x8006, counted(2, Bytes(8))));
  EXPECT_FALSE(is_taken(0x8006, counted(kHuge, Bytes(8))));
}

TEST(ParameterCheck, TakesFiltersAndTypesOnlyFromOthers) {
  const auto filter = [](const std::string& expression) {
    Bytes content = texts({"filtered", "topic", "DDSSQL", expression});
    content.resize(content.size() + 4);  // no parameters
    return content;
  };
  EXPECT_FALSE(is_taken(0x0035, filter("a = 1")));
  EXPECT_TRUE(is_taken(0x0035, filter("a = 1"), ParameterSender::kAnybody));
  EXPECT_FALSE(is_taken(0x0035, filter(std::string(300, '(')), ParameterSender::kAnybody))
      << "CVE-2026-22591";
  for (const std::uint16_t id : std::initializer_list<std::uint16_t>{0x0069, 0x0072, 0x0075}) {
    EXPECT_FALSE(is_taken(id, Bytes(16)));
    EXPECT_TRUE(is_taken(id, Bytes(16), ParameterSender::kAnybody));
  }
}

TEST(ParameterCheck, TakesWhatItDoesNotKnow) {
  EXPECT_TRUE(is_taken(0x7abc, Bytes(12, 0xff)));
}

}  // namespace
}  // namespace fleetloc
