// Whatever arrives: nobody crashes, and nobody else is harmed.
#include <array>
#include <random>

#include <gtest/gtest.h>

#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/answer_bytes.hpp"
#include "test/pipeline/simulated_system.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

constexpr std::array kTopics{Topic::kSession,
                             Topic::kSubmap,
                             Topic::kLocalization,
                             Topic::kRobotStatus,
                             Topic::kLocalizerStatus};
constexpr int kTrials = 20'000;

Bytes mutated(Bytes bytes, std::mt19937& random) {
  switch (random() % 4) {
    case 0:
      bytes.resize(random() % bytes.size());
      return bytes;
    case 1:  // an extreme number
      for (std::size_t i = 0, at = 4 * (random() % (bytes.size() / 4)); i < 4; ++i) {
        bytes[at + i] = random() % 2 == 0 ? 0xff : 0x7f;
      }
      return bytes;
    default:
      for (std::uint32_t i = random() % 8; i < 8; ++i) {
        bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1U << (random() % 8));
      }
      return bytes;
  }
}

RobotSession sound_session(const RobotId& robot) {
  RobotSession session = some_session();
  session.robot = robot;
  session.session = SessionNumber{2};
  session.localizer = "cloud-a";
  session.incarnation = Incarnation{17};
  session.start_stamp = Timestamp{};
  return session;
}

Submap sound_submap(const RobotId& robot, std::uint32_t number) {
  Submap submap = some_submap(4, 30);
  submap.robot = robot;
  submap.incarnation = Incarnation{17};
  submap.number = SampleNumber{number};
  return submap;
}

TEST(Corruption, OfWhatOneRobotSendsHarmsNeitherTheCloudNorAnotherRobot) {
  const auto map =
      std::make_shared<const LaserMap>(build_map({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                                 "map",
                                                 read_map_config(defaults().section("map"))));
  LocalizerPool pool("cloud-a", Incarnation{17}, map, read_localizer_pool_config(defaults()));
  std::mt19937 random(5);
  std::uint32_t sent = 0;
  int jobs = 0;
  Timestamp now{};
  pool.receive({Topic::kSession, encode(sound_session("victim"))}, now);
  pool.receive({Topic::kSession, encode(sound_session("mallory"))}, now);
  for (int trial = 0; trial < kTrials; ++trial) {
    now += std::chrono::milliseconds(5);
    RobotStatus status = some_robot_status();
    status.robot = "mallory";
    const std::array<Bytes, 5> valid{
        encode(sound_session("mallory")),
        encode(sound_submap("mallory", static_cast<std::uint32_t>(trial))),
        encode(some_answer()),
        encode(status),
        encode(some_localizer_status())};
    const std::size_t kind = random() % valid.size();
    const Topic topic = random() % 10 == 0 ? kTopics[random() % 5] : kTopics[kind];
    pool.receive({topic, mutated(valid[kind], random)}, now);
    if (trial % 100 == 0) {
      pool.receive({Topic::kSubmap, encode(sound_submap("victim", sent++))}, now);
      while (auto job = pool.take_job(now)) {
        LocalizationResult answer = LocalizerPool::run(*job);
        pool.finish(*job, std::move(answer), 1.0, now);
        ++jobs;
      }
      static_cast<void>(pool.outgoing(now, 0.0));
    }
  }
  const SessionReport victim = pool.reports().at("victim");
  EXPECT_EQ(victim.submaps, sent);
  EXPECT_EQ(victim.sessions, 1);
  EXPECT_TRUE(victim.refused.empty());
  EXPECT_GT(jobs, static_cast<int>(sent)) << "some of the corrupt submaps were worked on";
}

TEST(Corruption, OfWhatArrivesDoesNotEndTheService) {
  MemoryNetwork network(perfect_link());
  const auto robot_end = network.join_robot("robot_1");
  const auto cloud_end = network.join_cloud("cloud-a");
  CloudClient client("robot_1", *robot_end, read_cloud_client_config(defaults().section("client")));
  Timestamp now{};
  client.start_session(sound_session("robot_1"), now);
  std::mt19937 random(6);
  LocalizationResult answer = some_answer();
  const std::array<Bytes, 2> valid{encode(answer), encode(some_localizer_status())};
  constexpr std::array kHeard{Topic::kLocalization, Topic::kLocalizerStatus};
  for (int trial = 0; trial < kTrials; ++trial) {
    now += std::chrono::milliseconds(5);
    const std::size_t kind = random() % 2;
    cloud_end->send("robot_1", {kHeard[kind], mutated(valid[kind], random)}, now);
    static_cast<void>(client.take_answers(now));
    if (trial % 100 == 0) client.submit(sound_submap("robot_1", 0), now);
  }
  EXPECT_GT(client.statistics().refused.size(), 3);
  std::size_t received = 0;
  for (int i = 0; i < 120; ++i) {  // and then, once invented localizers are gone, all is well again
    now += std::chrono::seconds(1);
    cloud_end->send("", {Topic::kLocalizerStatus, valid[1]}, now);
    answer.keyframe = KeyframeId{200'000 + static_cast<std::uint32_t>(i)};
    cloud_end->send("robot_1", {Topic::kLocalization, encode(answer)}, now);
    client.submit(sound_submap("robot_1", 0), now);
    received += client.take_answers(now).size();
  }
  EXPECT_EQ(client.statistics().localizer, "cloud-a");
  EXPECT_GT(received, 40);
}

}  // namespace
}  // namespace fleetloc
