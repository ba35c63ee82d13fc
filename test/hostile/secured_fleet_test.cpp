// With keys: members that say what is not theirs, and strangers that forge the datagrams of members
// on the same computer.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <fastdds/dds/core/status/PublicationMatchedStatus.hpp>
#include <gtest/gtest.h>

#include "test/hostile/known_robot.hpp"
#include "test/hostile/recorded_datagrams.hpp"
#include "test/hostile/served_robot.hpp"
#include "test/transport/fleet_folder.hpp"

namespace fleetloc {
namespace {

class SecuredFleet : public testing::Test {
 protected:
  SecuredFleet() { load_secure_profiles(); }

  static const FleetFolder& fleet() {
    static const FleetFolder fleet("campus");
    return fleet;
  }
  [[nodiscard]] DdsChannelConfig robot_end(const std::string& name) const {
    return secure_on_loopback(
        domain_.number(), ChannelRole::kRobot, name, fleet().keys("robot", name));
  }
  [[nodiscard]] DdsChannelConfig localizer_end(const std::string& name) const {
    return secure_on_loopback(
        domain_.number(), ChannelRole::kCloud, name, fleet().keys("localizer", name));
  }

  TestDomain domain_;
};

/// A robot that is served.
class ServedInSecuredFleet : public SecuredFleet {
 protected:
  void SetUp() override {
    cloud_.emplace(localizer_end("cloud_1"));
    robot_.emplace(robot_end("robot_1"), time_of_test());
    ASSERT_TRUE(plays_until([&] { return robot_->answers() >= 3; }, play()));
    chosen_ = robot_->client().statistics().localizers_chosen;
  }

  std::function<void(Timestamp)> play() {
    return [this](Timestamp now) {
      cloud_->advance(now);
      robot_->advance(now);
    };
  }
  std::uint64_t refused_answers() {
    const auto refused = robot_->client().statistics().refused;
    const auto count = refused.find("foreign_writer");
    return count == refused.end() ? 0 : count->second;
  }
  void expect_answers(std::uint64_t more) {
    const std::uint64_t before = robot_->answers();
    EXPECT_TRUE(plays_until([&] { return robot_->answers() >= before + more; }, play()));
    EXPECT_EQ(robot_->client().statistics().localizers_chosen, chosen_);
    EXPECT_EQ(cloud_->pool()->reports().at("robot_1").sessions, 1);
  }

  std::optional<PlayedLocalizer> cloud_;
  std::optional<PlayedRobot> robot_;
  std::uint64_t chosen_ = 0;
};

TEST_F(ServedInSecuredFleet, ALocalizerSpeaksForItselfOnly) {
  constexpr Incarnation kHigher{99};
  DdsChannel rogue(localizer_end("cloud_2"));
  ASSERT_TRUE(matches(rogue, Topic::kLocalizerStatus, ""));
  ASSERT_TRUE(matches(rogue, Topic::kLocalization, "robot_1"));
  std::uint32_t keyframe = 1;
  EXPECT_TRUE(plays_until(
      [&] {
        return refused_answers() >= 10 &&
               robot_->channel().diagnostics().undecodable["foreign_writer"] >= 10;
      },
      [&](Timestamp now) {
        rogue.send("", as_message(status_of("cloud_1", kHigher)), now);
        rogue.send("robot_1", as_message(answer_of("cloud_1", ++keyframe)), now);
        play()(now);
      }));
  expect_answers(5);
}

TEST_F(ServedInSecuredFleet, ARobotOpensNoSessionOfTheFutureForAnotherNorAThousand) {
  DdsChannel rogue(robot_end("robot_7"));
  ASSERT_TRUE(matches(rogue, Topic::kSession, "cloud_1"));
  int sent = 0;
  EXPECT_TRUE(plays_until(
      [&] { return cloud_->channel().diagnostics().undecodable["foreign_writer"] >= 1000; },
      [&](Timestamp now) {
        rogue.send("cloud_1", as_message(session_for("robot_1", 99, at(2e9))), now);
        for (int i = 0; i < 20; ++i) {
          const RobotId id = "id_" + std::to_string(++sent % 1000);
          rogue.send("cloud_1", as_message(submap_of(id, 1)), now);
        }
        play()(now);
      }));
  EXPECT_EQ(cloud_->pool()->sessions(), 1U);
  expect_answers(5);
}

// Who has recorded it cannot read it, but can send it again.
TEST_F(SecuredFleet, WhatWasRecordedIsNotDeliveredAgain) {
  if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
  NetworkNamespace computer;
  const auto inside = computer.enter();
  DdsChannel cloud(localizer_end("cloud_1"));
  DdsChannel robot(robot_end("robot_1"));
  ASSERT_TRUE(matches(robot, Topic::kSubmap, "cloud_1"));
  RecordedDatagrams recording;
  const auto next_arrives = [&](std::uint32_t number) {
    return receives(
        cloud,
        [&] { robot.send("cloud_1", numbered_submap(number), {}); },
        [&](const Message& message) {
          EXPECT_GE(number_of(message), number) << "it is not delivered twice";
          return number_of(message) == number;
        });
  };
  for (std::uint32_t number = 1; number <= 20; ++number) ASSERT_TRUE(next_arrives(number));
  const auto recorded = recording.take();
  ASSERT_GT(recorded.size(), 20U);
  const Intruder beside(domain_.number(), 119);
  const Intruder elsewhere = Intruder::elsewhere(domain_.number(), 2);
  for (const auto& datagram : recorded) {
    beside.send_to_port(datagram.port, datagram.payload);
    elsewhere.send_to_port(datagram.port, datagram.payload);
  }
  ASSERT_TRUE(comes_true([&] { return cloud.diagnostics().malformed["foreign_guid"] >= 20; }));
  EXPECT_TRUE(next_arrives(21));
}

TEST_F(SecuredFleet, AStrangerOnTheSameComputerForgesNoSample) {
  DdsChannel cloud(localizer_end("cloud_1"));
  KnownRobot robot(domain_.number(), "secure_loopback", {.keys = fleet().keys("robot", "robot_1")});
  ASSERT_TRUE(robot.next_submap_arrives(cloud));
  const Intruder beside(domain_.number(), 119);
  constexpr std::uint64_t kFar = std::uint64_t{1} << 40U;
  for (const std::uint64_t number : {std::uint64_t{50}, std::uint64_t{51}, kFar}) {
    beside.send(robot.forged_submap(number));
  }
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(robot.next_submap_arrives(cloud));
}

}  // namespace
}  // namespace fleetloc
