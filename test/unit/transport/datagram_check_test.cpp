#include "shared/transport/workarounds/datagram_check.hpp"

#include <algorithm>
#include <random>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "test/transport/rtps_messages.hpp"

namespace fleetloc {
namespace {

std::string_view defect_of(const Bytes& datagram) {
  const auto checked = check_rtps(datagram);
  return checked ? "" : name(checked.error());
}

TEST(RtpsCheck, TakesEveryKindOfSubmessage) {
  for (const auto& [name, submessage] : valid_submessages()) {
    EXPECT_TRUE(check_rtps(message_of({submessage}))) << name;
  }
  const Bytes statistics = submessage(0x80, 1, Bytes(56));
  EXPECT_TRUE(check_rtps(message_of({heartbeat(1, 2), data_frag(1, 3000), statistics})));
  EXPECT_TRUE(check_rtps(message_of({})));
}

TEST(RtpsCheck, RefusesWhatIsCutOffAnywhere) {
  for (const auto& [name, submessage] : valid_submessages()) {
    const Bytes whole = message_of({submessage});
    for (std::size_t size = 0; size < whole.size(); ++size) {
      if (size == message_of({}).size()) continue;  // nothing but the header
      EXPECT_FALSE(check_rtps({whole.data(), size})) << name << " of " << size << " bytes";
    }
  }
}

TEST(RtpsCheck, NamesWhereADatagramIsCutOff) {
  const Bytes whole = message_of({heartbeat(1, 2)});
  EXPECT_EQ(defect_of({whole.begin(), whole.begin() + 19}), "not_rtps") << "in its header";
  EXPECT_EQ(defect_of({whole.begin(), whole.end() - 1}), "cut_short");
}

TEST(RtpsCheck, RefusesAnotherProtocolAndAnotherMajorVersion) {
  Bytes message = message_of({});
  message[0] = 'X';
  EXPECT_EQ(defect_of(message), "not_rtps");
  message = message_of({});
  message[4] = 3;
  EXPECT_EQ(defect_of(message), "version");
}

TEST(RtpsCheck, TakesWhatOthersAddToRtpsWhereThatIsAllowed) {
  constexpr RtpsLimits kOpen{.allows_extensions = true};
  const Bytes theirs = submessage(0x81, 1, Bytes(8));
  const Bytes of_a_later_version = submessage(0x00, 1, Bytes(4));
  for (const Bytes& extension : {theirs, of_a_later_version}) {
    const Bytes message = message_of({extension, heartbeat(1, 2)});
    EXPECT_EQ(defect_of(message), "unknown_submessage");
    EXPECT_TRUE(check_rtps(message, kOpen));
  }
  const Bytes broken = message_of({theirs, heartbeat(0, 2)});
  EXPECT_FALSE(check_rtps(broken, kOpen)) << "the submessage behind it";

  Bytes statistics = message_of({submessage(0x80, 1, Bytes(8)), heartbeat(1, 2)});
  EXPECT_FALSE(check_rtps(statistics, kOpen)) << "of Fast DDS, which has them elsewhere";
  constexpr std::size_t kVendorAt = 6;
  statistics[kVendorAt + 1] = 16;
  EXPECT_TRUE(check_rtps(statistics, kOpen)) << "to another vendor that is something else";
}

TEST(RtpsCheck, RefusesAFragmentOfASampleThatIsLargerThanAny) {
  constexpr RtpsLimits kSmall{.largest_sample_bytes = 3000};
  EXPECT_TRUE(check_rtps(message_of({data_frag(1, 3000)}), kSmall));
  EXPECT_FALSE(check_rtps(message_of({data_frag(1, 3001)}), kSmall));
}

TEST(RtpsCheck, TakesStatisticsOnlyWhereFastDdsPutsThem) {
  const Bytes statistics = submessage(0x80, 1, Bytes(56));
  EXPECT_TRUE(check_rtps(message_of({heartbeat(1, 2), statistics})));
  EXPECT_EQ(defect_of(message_of({statistics, heartbeat(1, 2)})), "statistics");
  EXPECT_EQ(defect_of(message_of({submessage(0x80, 1, Bytes(52))})), "statistics");
  EXPECT_EQ(defect_of(message_of({submessage(0x81, 1, Bytes(56))})), "unknown_submessage");
}

TEST(RtpsCheck, RefusesASetOfMoreThan256Numbers) {
  EXPECT_TRUE(check_rtps(message_of({ack_nack(256)})));
  EXPECT_EQ(defect_of(message_of({ack_nack(257)})), "invalid_submessage");
  EXPECT_FALSE(check_rtps(message_of({ack_nack(0xffffffff)})));
}

TEST(RtpsCheck, RefusesAHeartbeatThatEndsBeforeItBegins) {
  EXPECT_TRUE(check_rtps(message_of({heartbeat(3, 2)})));  // an empty history
  EXPECT_FALSE(check_rtps(message_of({heartbeat(3, 1)})));
  EXPECT_FALSE(check_rtps(message_of({heartbeat(0, 5)})));
}

TEST(RtpsCheck, RefusesRangesThatWouldTakeForeverToWalkThrough) {
  constexpr std::uint64_t kFar = std::uint64_t{1} << 40U;
  EXPECT_TRUE(check_rtps(message_of({heartbeat(kFar, kFar + 10)})));
  EXPECT_FALSE(check_rtps(message_of({heartbeat(1, kFar)})));
  EXPECT_TRUE(check_rtps(message_of({gap(kFar, kFar + 10)})));
  EXPECT_FALSE(check_rtps(message_of({gap(1, kFar)})));
  EXPECT_FALSE(check_rtps(message_of({gap(5, 4)})));
}

TEST(RtpsCheck, RefusesFragmentsBeyondTheSample) {
  EXPECT_TRUE(check_rtps(message_of({data_frag(1, 3000)})));
  EXPECT_TRUE(check_rtps(message_of({data_frag(3, 3000)})));
  EXPECT_FALSE(check_rtps(message_of({data_frag(4, 3000)})));
  EXPECT_FALSE(check_rtps(message_of({data_frag(0, 3000)})));
  EXPECT_TRUE(check_rtps(message_of({data_frag(1, 300'000)})));
  EXPECT_FALSE(check_rtps(message_of({data_frag(1, 600'000)})));
  EXPECT_FALSE(check_rtps(message_of({data_frag(1, 0x7fffffff)})));
}

TEST(RtpsCheck, RefusesFragmentsInWhichNoNumberOfOneHasRoom) {  // CVE-2025-62799
  EXPECT_TRUE(check_rtps(message_of({data_frag(1, 1000)}))) << "the only one";
  EXPECT_TRUE(check_rtps(message_of({data_frag(1, 2004)})));
  EXPECT_FALSE(check_rtps(message_of({data_frag(1, 2003)})));
}

TEST(RtpsCheck, RefusesAKeyInFragments) {
  Bytes fragment = data_frag(1, 3000);
  fragment[1] |= 0x04;
  EXPECT_FALSE(check_rtps(message_of({fragment})));
}

TEST(RtpsCheck, RefusesDiscoveryInFragments) {
  EXPECT_FALSE(check_rtps(message_of({data_frag(1, 3000, kPublicationsWriter)})));
}

TEST(RtpsCheck, RefusesAnOffsetThatTheLibraryTakesForANegativeOne) {
  const auto with_offset = [](std::uint16_t offset) {
    return submessage(0x15,
                      1,
                      ByteWriter()
                          .u16(0)
                          .u16(offset)
                          .entity(0)
                          .entity(0x102)
                          .sequence_number(5)
                          .zeros(0x9000)
                          .written());
  };
  EXPECT_TRUE(check_rtps(message_of({with_offset(0x7ffc)})));
  EXPECT_FALSE(check_rtps(message_of({with_offset(0x8000)})));
}

TEST(RtpsCheck, RefusesParametersThatRunOverTheEnd) {
  EXPECT_TRUE(check_rtps(message_of({announcement({{0x0015, 4}, {0x0050, 16}})})));
  EXPECT_FALSE(check_rtps(message_of({announcement({{0x0015, 4}, {0x0050, 18}})})));
  Bytes endless = announcement({{0x0015, 4}});
  endless[endless.size() - 4] = 0x15;  // in place of the sentinel
  EXPECT_FALSE(check_rtps(message_of({endless})));
}

TEST(RtpsCheck, ReadsNoByteBeyondTheDatagram) {  // under AddressSanitizer
  std::mt19937 random(3);
  int taken = 0;
  for (int trial = 0; trial < 20'000; ++trial) {
    Bytes message = random_message(random);
    message.shrink_to_fit();
    if (check_rtps(message)) ++taken;
  }
  EXPECT_GT(taken, 1000);
  EXPECT_LT(taken, 19'000);
}

TEST(RtpsCheck, TakesSubmessagesThatAreEncryptedOrSigned) {
  const Bytes destination = submessage(0x0e, 1, Bytes(12));
  const Bytes statistics = submessage(0x80, 1, Bytes(56));
  EXPECT_TRUE(check_rtps(message_of(encrypted_submessage())));
  EXPECT_TRUE(check_rtps(message_of({secure_prefix(3), heartbeat(1, 2), secure_postfix(0, 0)})));
  EXPECT_TRUE(check_rtps(message_of({destination,
                                     secure_prefix(2),
                                     secure_body(8, 8),
                                     secure_postfix(2, 2),
                                     heartbeat(1, 2),
                                     secure_prefix(4),
                                     secure_body(8, 8),
                                     secure_postfix(0, 0),
                                     statistics})));
}

TEST(RtpsCheck, TakesMessagesThatAreEncryptedOrSigned) {
  const Bytes statistics = submessage(0x80, 1, Bytes(56));
  const Bytes end = secure_postfix(1, 1, 0x34);
  EXPECT_TRUE(check_rtps(message_of({secure_prefix(4, 0x33), secure_body(60, 60), end})));
  EXPECT_TRUE(
      check_rtps(message_of({secure_prefix(4, 0x33), secure_body(60, 60), end, statistics})));
  EXPECT_TRUE(check_rtps(message_of(
      {secure_prefix(3, 0x33), submessage(0x0c, 1, Bytes(20)), heartbeat(1, 2), gap(1, 3), end})));
}

TEST(RtpsCheck, RefusesAnEncryptedBodyThatSaysItIsLongerThanItIs) {
  EXPECT_EQ(defect_of(message_of({secure_prefix(4), secure_body(41, 40), secure_postfix(0, 0)})),
            "protection");
  EXPECT_EQ(
      defect_of(message_of({secure_prefix(4), secure_body(0x7fffffff, 40), secure_postfix(0, 0)})),
      "protection");
  EXPECT_EQ(defect_of(message_of(
                {secure_prefix(4), submessage(0x30, 1, Bytes(3)), secure_postfix(0, 0)})),
            "protection");
}

TEST(RtpsCheck, RefusesProtectionInAnotherOrderThanThatOfDdsSecurity) {
  const Bytes begin = secure_prefix(4);
  const Bytes body = secure_body(8, 8);
  const Bytes end = secure_postfix(0, 0);
  const Bytes signed_begin = secure_prefix(3);
  const Bytes plain = heartbeat(1, 2);
  const Bytes begin_all = secure_prefix(4, 0x33);
  const Bytes end_all = secure_postfix(0, 0, 0x34);
  const std::vector<std::vector<Bytes>> wrong{
      {begin},
      {begin, body},
      {body, end},
      {body},
      {end},
      {begin, end},
      {begin, end, body},
      {begin, plain, end},        // it says that it is encrypted: the library reads a length there
      {signed_begin, body, end},  // and here that it is not
      {begin, body, body, end},
      {begin, begin, body, end},
      {begin, body, plain, end},
      {signed_begin, end},
      {signed_begin, plain, plain, end},
      {begin, body, end_all},
      {begin_all, body, end},
      {begin_all, body},
      {begin_all, body, plain, end_all},
      {plain, begin_all, body, end_all},
      {begin_all, body, end_all, plain},
      {begin_all, body, end_all, end_all},
      {begin_all, begin, body, end, end_all},
      {secure_prefix(0), plain, end},
      {secure_prefix(5), plain, end},
      {secure_prefix(6), body, end},
      {submessage(0x31, 1, Bytes{0, 0, 0, 3}), plain, end},
      {begin, body, secure_postfix(1, 0)},
      {begin, body, secure_postfix(0, 1)},
      {begin, body, submessage(0x32, 1, Bytes(16))}};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_EQ(defect_of(message_of(wrong[i])), "protection") << "number " << i;
  }
}

TEST(RtpsCheck, LooksIntoWhatIsOnlySigned) {
  const Bytes broken = heartbeat(0, 2);
  EXPECT_EQ(defect_of(message_of({secure_prefix(3), broken, secure_postfix(0, 0)})),
            "invalid_submessage");
}

// As if it were of a topic of the fleet: in the test's messages all are of discovery.
Bytes of_a_topic(Bytes submessage) {
  const Bytes discovery = ByteWriter().entity(kPublicationsWriter).written();
  const Bytes user = ByteWriter().entity(0x103).written();
  const auto found = std::ranges::search(submessage, discovery);
  std::ranges::copy(user, found.begin());
  return submessage;
}

TEST(RtpsCheck, RefusesWhatIsNotProtectedWhereTheFleetHasKeys) {
  constexpr RtpsLimits kKeys{.needs_protection = true};
  for (const auto& [name, submessage] : valid_submessages()) {
    const bool is_sample = name == "DATA" || name == "DATA_FRAG";  // of a topic they are
    EXPECT_EQ(check_rtps(message_of({submessage}), kKeys).has_value(), !is_sample) << name;
  }
  const Bytes end = secure_postfix(0, 0);
  const Bytes end_all = secure_postfix(0, 0, 0x34);
  for (const auto& [name, submessage] : valid_submessages()) {
    const bool has_number = name.ends_with("NACK") || name.ends_with("FRAG") || name == "GAP" ||
                            name.starts_with("HEARTBEAT") || name == "DATA";
    if (!has_number) continue;
    const Bytes ours = name.starts_with("DATA") ? submessage : of_a_topic(submessage);
    EXPECT_TRUE(check_rtps(message_of({ours}))) << name << " without keys";
    const auto checked = check_rtps(message_of({ours}), kKeys);
    ASSERT_FALSE(checked) << name;
    EXPECT_EQ(fleetloc::name(checked.error()), "unprotected") << name;
    EXPECT_TRUE(check_rtps(message_of({secure_prefix(3), ours, end}), kKeys)) << name;
    EXPECT_TRUE(check_rtps(message_of({secure_prefix(3, 0x33), ours, end_all}), kKeys)) << name;
    EXPECT_FALSE(check_rtps(message_of({secure_prefix(3), ours, end, ours}), kKeys)) << name;
  }
  EXPECT_TRUE(check_rtps(message_of(encrypted_submessage()), kKeys));
}

// Strangers may send these: an authentication begins with one.
TEST(RtpsCheck, RefusesAHandshakeThatSaysItHasMoreThanItHas) {
  EXPECT_TRUE(check_rtps(message_of({handshake(1)})));
  EXPECT_EQ(defect_of(message_of({handshake(2)})), "invalid_submessage");
  EXPECT_EQ(defect_of(message_of({handshake(0x02000000)})), "invalid_submessage");
  EXPECT_EQ(defect_of(message_of({data_frag(1, 3000, 0x0201c3)})), "invalid_submessage");
}

}  // namespace
}  // namespace fleetloc
