// DDS Security between members of a fleet, and against those who are none.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>

#include <fastdds/dds/core/status/PublicationMatchedStatus.hpp>
#include <fastdds/dds/core/status/SubscriptionMatchedStatus.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/transport/topic_observer.hpp"
#include "test/system/network_namespace.hpp"
#include "test/transport/discovery_server.hpp"
#include "test/transport/fleet_folder.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using testing::HasSubstr;

constexpr std::uint32_t kForeign = 1000;

class FleetSecurity : public testing::Test {
 protected:
  FleetSecurity() { load_secure_profiles(); }

  [[nodiscard]] std::unique_ptr<DdsChannel> robot(const FleetFolder& fleet,
                                                  const std::string& name) const {
    return std::make_unique<DdsChannel>(
        secure_on_loopback(domain_.number(), ChannelRole::kRobot, name, fleet.keys("robot", name)));
  }
  [[nodiscard]] std::unique_ptr<DdsChannel> localizer(const FleetFolder& fleet,
                                                      const std::string& name) const {
    return std::make_unique<DdsChannel>(secure_on_loopback(
        domain_.number(), ChannelRole::kCloud, name, fleet.keys("localizer", name)));
  }

  /// A submap arrives, and then an answer to it; and nothing with a number from kForeign on.
  static bool exchange(DdsChannel& robot, DdsChannel& cloud, std::uint32_t number) {
    const auto is_submap = [&](const Message& message) {
      if (message.topic != Topic::kSubmap) return false;
      EXPECT_LT(number_of(message), kForeign);
      return number_of(message) == number;
    };
    const auto is_answer = [&](const Message& message) {
      if (message.topic != Topic::kLocalization) return false;
      const auto answer = from_bytes<wire::LocalizationResultPubSubType>(message.payload);
      EXPECT_LT(answer.acknowledged_base(), kForeign);
      return answer.acknowledged_base() == number;
    };
    const auto submap = [&] { robot.send("cloud_1", numbered_submap(number, "robot_1"), {}); };
    const auto answer = [&] { cloud.send("robot_1", answer_to(number, wire::LOCALIZED), {}); };
    return receives(cloud, submap, is_submap) && receives(robot, answer, is_answer);
  }

  static const FleetFolder& fleet() {
    static const FleetFolder fleet("campus");
    return fleet;
  }

  TestDomain domain_;
};

TEST_F(FleetSecurity, MembersExchangeASubmapAndAnAnswer) {
  const auto one = robot(fleet(), "robot_1");
  const auto cloud = localizer(fleet(), "cloud_1");
  EXPECT_TRUE(exchange(*one, *cloud, 7));
  EXPECT_THAT(one->diagnostics().malformed, testing::IsEmpty());
  EXPECT_THAT(cloud->diagnostics().malformed, testing::IsEmpty());
}

/// On the wire, with all headers, of a submap; the least of several, as announcements come by and
/// some are sent twice.
std::uint64_t bytes_of_a_sample(DdsChannel& robot, DdsChannel& cloud, std::size_t rows = 0) {
  std::uint64_t least = 100'000;
  for (std::uint32_t number = 1; number <= 20; ++number) {
    const std::uint64_t before = robot.statistics().sent_wire_bytes;
    EXPECT_TRUE(receives(
        cloud,
        [&] { robot.send("cloud_1", numbered_submap(number, "robot_1", rows), {}); },
        [&](const Message& message) { return number_of(message) == number; }));
    const std::uint64_t sent = robot.statistics().sent_wire_bytes - before;
    if (sent > 0) least = std::min(least, sent);
  }
  return least;
}

// Each with headers of its own.
TEST_F(FleetSecurity, ALongSubmapArrivesInPiecesOf1400Bytes) {
  constexpr std::size_t kRows = 3000;
  constexpr std::uint64_t kHeaders = 28 + 20 + 48;  // the least of a piece
  const auto one = robot(fleet(), "robot_1");
  const auto cloud = localizer(fleet(), "cloud_1");
  ASSERT_TRUE(matches(*one, Topic::kSubmap, "cloud_1"));
  const std::uint64_t payload = numbered_submap(1, "robot_1", kRows).payload.size();
  ASSERT_GT(payload, 6000U);
  EXPECT_GT(bytes_of_a_sample(*one, *cloud, kRows), payload + (payload / 1400 + 1) * kHeaders);
}

TEST_F(FleetSecurity, ASampleCostsUpTo160BytesMore) {
  const auto one = robot(fleet(), "robot_1");
  const auto cloud = localizer(fleet(), "cloud_1");
  DdsChannel plain_one(on_loopback(domain_.number(), ChannelRole::kRobot, "robot_1"));
  DdsChannel plain_cloud(on_loopback(domain_.number(), ChannelRole::kCloud, "cloud_1"));
  ASSERT_TRUE(matches(*one, Topic::kSubmap, "cloud_1"));
  ASSERT_TRUE(matches(plain_one, Topic::kSubmap, "cloud_1"));
  const std::uint64_t with = bytes_of_a_sample(*one, *cloud);
  const std::uint64_t without = bytes_of_a_sample(plain_one, plain_cloud);
  RecordProperty("bytes_more", std::to_string(with - without));
  EXPECT_GT(with, without + 48) << "a prefix, a postfix: it is protected";
  EXPECT_LE(with, without + 160) << with << " instead of " << without;
}

// With the names of members, and permissions that its own CA has signed for all of that.
TEST_F(FleetSecurity, AMemberOfAnotherFleetSeesAndChangesNothing) {
  const FleetFolder other("elsewhere");
  const auto one = robot(fleet(), "robot_1");
  const auto cloud = localizer(fleet(), "cloud_1");
  const auto false_robot = robot(other, "robot_1");
  const auto false_cloud = localizer(other, "cloud_1");
  TopicObserver observer(
      domain_.number(), "secure_loopback", "loopback", other.keys("observer", "spy"));
  observer.read(topic_spec(Topic::kSubmap, "cloud_1").name);
  observer.read(topic_spec(Topic::kLocalization, "robot_1").name);
  ASSERT_TRUE(matches(*false_robot, Topic::kSubmap, "cloud_1")) << "those of the other fleet do";
  for (std::uint32_t number = 1; number <= 20; ++number) {
    false_robot->send("cloud_1", numbered_submap(kForeign + number, "robot_1"), {});
    false_cloud->send("robot_1", answer_to(kForeign + number, wire::LOCALIZED), {});
    ASSERT_TRUE(exchange(*one, *cloud, number));
  }
  EXPECT_EQ(one->matched_readers(Topic::kSubmap, "cloud_1"), 1) << "its localizer only";
  EXPECT_EQ(cloud->matched_readers(Topic::kLocalization, "robot_1"), 1) << "its robot only";
  // The observer has found those of its own fleet, whose readers and writers are 1 of each topic.
  ASSERT_TRUE(comes_true([&] { return observer.topics().size() >= 4; }));
  for (const ObservedTopic& topic : observer.topics()) {
    EXPECT_LE(topic.readers, 1) << topic.name;
    EXPECT_LE(topic.writers, 1) << topic.name;
  }
  for (const ObservedSample& sample : observer.take()) {
    if (sample.topic != topic_spec(Topic::kSubmap, "cloud_1").name) continue;
    EXPECT_GE(from_bytes<wire::SubmapPubSubType>(sample.payload).number(), kForeign);
  }
}

TEST_F(FleetSecurity, WhoHasNoKeysMatchesNobody) {
  const auto one = robot(fleet(), "robot_1");
  const auto cloud = localizer(fleet(), "cloud_1");
  DdsChannel without(on_loopback(domain_.number(), ChannelRole::kRobot, "robot_2"));
  DdsChannel another(on_loopback(domain_.number(), ChannelRole::kCloud, "cloud_1"));
  ASSERT_TRUE(matches(without, Topic::kSubmap, "cloud_1")) << "the one without keys, too";
  ASSERT_TRUE(exchange(*one, *cloud, 1));
  without.send("cloud_1", numbered_submap(kForeign, "robot_1"), {});
  ASSERT_TRUE(exchange(*one, *cloud, 2));
  EXPECT_EQ(one->matched_readers(Topic::kSubmap, "cloud_1"), 1);
  EXPECT_EQ(without.matched_readers(Topic::kSubmap, "cloud_1"), 1);
}

TEST_F(FleetSecurity, ARobotsKeyNeitherWritesNorReadsAnothersTopics) {
  Participant seven(
      domain_.number(), "secure_loopback", nullptr, {.keys = fleet().keys("robot", "robot_7")});
  const TopicSpec of_eight = topic_spec(Topic::kLocalization, "robot_8");
  EXPECT_THAT(refusal([&] { seven.create_writer(of_eight); }), HasSubstr("robot_8"));
  EXPECT_THAT(refusal([&] { seven.create_reader(of_eight); }), HasSubstr("robot_8"));
  const TopicSpec to_localizer = topic_spec(Topic::kSubmap, "cloud_1");
  EXPECT_THAT(refusal([&] { seven.create_reader(to_localizer); }), HasSubstr("cloud_1"));
  EXPECT_EQ(refusal([&] { seven.create_writer(to_localizer); }), "no error");
  EXPECT_EQ(refusal([&] { seven.create_reader(topic_spec(Topic::kLocalization, "robot_7")); }),
            "no error");
}

// As if its program did not ask whether it may: by rules under which nobody checks that topic.
TEST_F(FleetSecurity, OthersRefuseWhatARobotMayNotWrite) {
  const FleetFolder careless("campus");
  const auto folder = careless.member("robot", "robot_7");
  std::string rules = content_of(careless.ca() / "governance.xml");
  const std::string begin = "<topic_access_rules>";
  const std::string end = "</topic_rule>";
  const auto from = rules.find(begin) + begin.size();
  std::string unchecked = rules.substr(from, rules.find(end) + end.size() - from);
  const auto replace = [&](const std::string& what, const std::string& by) {
    ASSERT_NE(unchecked.find(what), std::string::npos);
    unchecked.replace(unchecked.find(what), what.size(), by);
  };
  replace(">*<", ">" + topic_spec(Topic::kLocalization, "robot_8").name + "<");
  replace("write_access_control>true", "write_access_control>false");
  rules.insert(from, unchecked);
  const auto ca = careless.ca().string();
  std::ofstream(careless.path("rules.xml")) << rules;
  const Outcome signing = run("/usr/bin/openssl",
                              {"smime",
                               "-sign",
                               "-text",
                               "-in",
                               careless.path("rules.xml").string(),
                               "-out",
                               (folder / "governance.smime").string(),
                               "-signer",
                               ca + "/certificate.pem",
                               "-inkey",
                               ca + "/key.pem"});
  ASSERT_EQ(signing.exit_code, 0) << signing.errors;
  Participant seven(domain_.number(), "secure_loopback", nullptr, {.keys = FleetKeys(folder)});
  const auto forbidden = seven.create_writer(topic_spec(Topic::kLocalization, "robot_8"));
  const auto allowed = seven.create_writer(topic_spec(Topic::kSubmap, "cloud_1"));
  const auto eight = robot(careless, "robot_8");
  const auto cloud = localizer(careless, "cloud_1");
  eprosima::fastdds::dds::PublicationMatchedStatus matched;
  ASSERT_TRUE(matches(*cloud, Topic::kLocalization, "robot_8")) << "the localizer may";
  ASSERT_TRUE(comes_true([&] {
    allowed->get_publication_matched_status(matched);
    return matched.current_count == 1;
  })) << "and robot_7 may write its submaps";
  Bytes answer = answer_to(666, wire::LOCALIZED).payload;
  ASSERT_TRUE(receives(
      *eight,
      [&] {
        forbidden->write(&answer);
        cloud->send("robot_8", answer_to(1, wire::LOCALIZED), {});
      },
      [&](const Message& message) {
        if (message.topic != Topic::kLocalization) return false;
        const auto result = from_bytes<wire::LocalizationResultPubSubType>(message.payload);
        EXPECT_NE(result.acknowledged_base(), 666U);
        return true;
      }));
  forbidden->get_publication_matched_status(matched);
  EXPECT_EQ(matched.total_count, 0);
}

TEST_F(FleetSecurity, ARobotThatSpeaksInAnothersNameIsRefusedAndCounted) {
  const auto seven = robot(fleet(), "robot_7");
  const auto cloud = localizer(fleet(), "cloud_1");
  EXPECT_TRUE(receives(
      *cloud,
      [&] {
        seven->send("cloud_1", numbered_submap(1, "robot_8"), {});
        seven->send("cloud_1", session_of("robot_8"), {});
        seven->send("cloud_1", numbered_submap(2, "robot_7"), {});
      },
      [&](const Message& message) {
        EXPECT_EQ(message.topic, Topic::kSubmap);
        EXPECT_EQ(number_of(message), 2U);
        return cloud->diagnostics().undecodable["foreign_writer"] >= 2;
      }));
}

TEST_F(FleetSecurity, WhoIsRevokedIsKeptOut) {
  const FleetFolder careful("campus");
  const auto one = robot(careful, "robot_1");  // has started before
  careful.tool({"revoke", "robot", "robot_1"});
  const auto cloud = localizer(careful, "cloud_1");
  const auto two = robot(careful, "robot_2");
  ASSERT_TRUE(matches(*two, Topic::kSubmap, "cloud_1"));
  EXPECT_EQ(one->matched_readers(Topic::kSubmap, "cloud_1"), 0);
  EXPECT_THAT(refusal([&] { static_cast<void>(robot(careful, "robot_1")); }),
              HasSubstr("certificate.pem: is revoked"));
}

TEST_F(FleetSecurity, AParticipantThatIsMadeAgainIsTheSameMember) {
  const auto keys = fleet().keys("robot", "robot_1");
  const auto begin = keys.guid_begin(FleetRole::kRobot, "robot_1");
  std::optional<ParticipantIdentity> before;
  for (int i = 0; i < 3; ++i) {
    const Participant one(
        domain_.number(), "secure_loopback", nullptr, {.predecessor = before, .keys = keys});
    const auto& prefix = one.identity().prefix.value;
    EXPECT_TRUE(std::equal(begin.begin(), begin.end(), prefix));
    EXPECT_LT(one.identity().id, 120) << "the id that determines its ports";
    if (before) {
      EXPECT_NE(one.identity().prefix, before->prefix);
    }
    before = one.identity();
  }
}

// Fast DDS 2.9.1 sends no secured discovery through a server, so nobody finds anybody: take peers.
TEST_F(FleetSecurity, ADiscoveryServerLetsNoMemberFindAnother) {
  if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
  if (const auto reason = DiscoveryServer::why_impossible()) GTEST_SKIP() << *reason;
  NetworkNamespace computer;
  const auto inside = computer.enter();
  const DiscoveryServer server;
  const auto client = [&](ChannelRole role, const std::string& kind, const std::string& name) {
    auto config = secure_on_loopback(domain_.number(), role, name, fleet().keys(kind, name));
    config.participant_profile = "secure_client";
    return config;
  };
  const auto plain = [&](ChannelRole role, const std::string& name) {
    auto config = on_loopback(domain_.number(), role, name);
    config.participant_profile = "loopback_client";
    return config;
  };
  DdsChannel cloud(client(ChannelRole::kCloud, "localizer", "cloud_1"));
  DdsChannel robot(client(ChannelRole::kRobot, "robot", "robot_1"));
  robot.prepare("cloud_1");
  DdsChannel plain_cloud(plain(ChannelRole::kCloud, "cloud_2"));
  DdsChannel plain_robot(plain(ChannelRole::kRobot, "robot_2"));
  ASSERT_TRUE(matches(plain_robot, Topic::kSubmap, "cloud_2")) << "those without keys do";
  const auto a_while = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while (std::chrono::steady_clock::now() < a_while) {
    plain_robot.wait_for_message(std::chrono::milliseconds(100));
    ASSERT_EQ(robot.matched_readers(Topic::kSubmap, "cloud_1"), 0)
        << "it works: offer -secure-server";
  }
}

}  // namespace
}  // namespace fleetloc
