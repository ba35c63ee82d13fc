// Well-formed messages that the wrong program says, to a localizer's and to a robot's end of the
// protocol: from another computer, and from the same one, where no network tells them apart.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot/cloud_client/cloud_client.hpp"
#include "test/hostile/small_pool.hpp"

namespace fleetloc {
namespace {

using testing::Contains;
using testing::HasSubstr;

MessageSender program(std::uint8_t number, std::uint8_t computer) {
  MessageSender sender;
  sender.participant = {1, 15, number};
  sender.address = 0x0a000000U + computer;
  return sender;
}

const MessageSender kHonest = program(1, 1);
const MessageSender kBeside = program(2, 1);   // on the same computer
const MessageSender kForeign = program(3, 9);  // elsewhere

/// A localizer, and robot_1, which drives.
class ForgedToALocalizer : public testing::Test {
 protected:
  ForgedToALocalizer() {
    says(kHonest, as_message(session_for("robot_1", 1, at(1000.0))), 0.0);
    drive_until(5.0);
  }

  void says(const MessageSender& sender, Message message, double s) {
    message.sender = sender;
    pool_->receive(message, at(s));
  }
  /// It sends 2 submaps a second.
  void drive_until(double s) {
    for (; now_s_ < s; now_s_ += 0.5) {
      says(kHonest, as_message(submap_of("robot_1", number_++)), now_s_);
      pool_.run_jobs(at(now_s_));
      static_cast<void>(pool_->outgoing(at(now_s_), 0.0));
    }
  }
  std::uint64_t stored() { return pool_->reports().at("robot_1").submaps; }
  std::uint64_t refused(const std::string& reason) { return pool_.refused("robot_1", reason); }

  SmallPool pool_;
  double now_s_ = 0.0;
  std::uint32_t number_ = 0;
};

TEST_F(ForgedToALocalizer, ASessionOfTheFutureFromElsewhereIsRefusedAndTheRobotIsServedOn) {
  const std::uint64_t before = stored();
  for (int i = 0; i < 20; ++i) {
    says(kForeign, as_message(session_for("robot_1", 99, at(1e9 + i))), 5.0);
    says(kForeign, as_message(submap_of("robot_1", 7, 99)), 5.0);
  }
  drive_until(10.0);
  EXPECT_EQ(stored(), before + 10U);
  EXPECT_EQ(pool_->reports().at("robot_1").sessions, 1);
  EXPECT_EQ(refused("foreign_writer"), 40U);
  EXPECT_THAT(pool_->take_events(), Contains(HasSubstr("another program speaks for it")));
}

// What cannot be told from a restart is believed, and forgotten when nothing follows it.
TEST_F(ForgedToALocalizer, ASessionOfTheFutureFromTheSameComputerKeepsTheRobotOutForHalfAMinute) {
  const std::uint64_t before = stored();
  says(kBeside, as_message(session_for("robot_1", 99, at(1e9))), 5.0);
  drive_until(35.0);
  EXPECT_EQ(stored(), before) << "this is not defended";
  const double back_s = 41.0;
  for (; now_s_ < 60.0; now_s_ += 0.5) {  // the robot announces itself as long as nobody answers
    says(kHonest, as_message(session_for("robot_1", 1, at(1000.0))), now_s_);
    says(kHonest, as_message(submap_of("robot_1", number_++)), now_s_);
    if (now_s_ < back_s) continue;
    ASSERT_GT(stored(), before) << now_s_;
  }
}

TEST_F(ForgedToALocalizer, OldSessionsAndSubmapsThatAreReplayedChangeNothing) {
  const Message old_session = as_message(session_for("robot_1", 1, at(1000.0)));
  const Message old_submap = as_message(submap_of("robot_1", number_ - 1));
  says(kHonest, as_message(session_for("robot_1", 2, at(1000.0))), 5.0);
  const auto drive = [&](std::uint32_t number, double s) {
    says(kHonest, as_message(submap_of("robot_1", number, 2)), s);
  };
  drive(1, 5.5);
  const std::uint64_t before = stored();
  for (const MessageSender& sender : {kHonest, kBeside, kForeign}) {
    says(sender, old_session, 6.0);
    says(sender, old_submap, 6.0);
  }
  drive(2, 6.5);
  says(kHonest, as_message(submap_of("robot_1", 2, 2)), 6.6);  // and the newest once more
  EXPECT_EQ(stored(), before + 1U);
  EXPECT_EQ(pool_->reports().at("robot_1").sessions, 2);
  EXPECT_EQ(refused("outdated_session"), 4U);
  EXPECT_EQ(refused("foreign_writer"), 2U);
  EXPECT_EQ(refused("seen_before"), 1U);
}

TEST_F(ForgedToALocalizer, ASampleNumberFarAheadMakesNobodyDeaf) {
  const std::uint64_t before = stored();
  says(kForeign, as_message(submap_of("robot_1", 4'000'000'000)), 5.0);
  says(kBeside, as_message(submap_of("robot_1", 4'000'000'000)), 5.0);
  drive_until(10.0);
  EXPECT_EQ(stored(), before + 10U);
  EXPECT_EQ(refused("foreign_writer"), 1U);
  EXPECT_EQ(refused("seen_before"), 1U);
}

TEST_F(ForgedToALocalizer, AThousandIdsOfOneProgramAreOne) {
  for (int i = 0; i < 1000; ++i) {
    const RobotId id = "id_" + std::to_string(i);
    says(kForeign, as_message(session_for(id)), 5.0);
    says(kForeign, as_message(submap_of(id, 1)), 5.0);
  }
  EXPECT_EQ(pool_->sessions(), 2U);
  EXPECT_EQ(pool_.refused("id_1", "foreign_writer"), 2 * 999U);
}

// Each from a computer of its own: those who are served stay served, newcomers find it full.
TEST_F(ForgedToALocalizer, AThousandProgramsFillALocalizerAndPutNobodyOut) {
  for (int i = 0; i < 2000; ++i) {
    MessageSender sender = program(4, 0);
    sender.participant[3] = static_cast<std::uint8_t>(i >> 8);
    sender.participant[4] = static_cast<std::uint8_t>(i);
    sender.address += 1000U + static_cast<std::uint32_t>(i);
    says(sender, as_message(session_for("id_" + std::to_string(i))), 5.0);
  }
  EXPECT_EQ(pool_->sessions(), 1000U);
  EXPECT_EQ(pool_.refused("id_1999", "too_many_sessions"), 1001U);
  const std::uint64_t before = stored();
  drive_until(7.0);
  EXPECT_EQ(stored(), before + 4U);
}

/// What arrives at a robot, from whom a test says.
class Mailbox final : public Channel {
 public:
  void put(const MessageSender& sender, Message message) {
    message.sender = sender;
    inbox_.push_back(std::move(message));
  }
  void send(const std::string& /*receiver*/, Message /*message*/, Timestamp /*now*/) override {}
  std::vector<Message> receive(Timestamp /*now*/) override { return std::exchange(inbox_, {}); }
  ChannelStatistics statistics() const override { return {}; }

 private:
  std::vector<Message> inbox_;
};

/// robot_1, which has chosen cloud_1.
class ForgedToARobot : public testing::Test {
 protected:
  ForgedToARobot() {
    client_.start_session(session_for("robot_1"), at(0.0));
    says(kHonest, as_message(status_of("cloud_1")));
    take(0.1);
    EXPECT_EQ(client_.statistics().localizer, "cloud_1");
    for (std::uint32_t i = 1; i <= 5; ++i) client_.submit(submap_of("robot_1", i), at(0.1 * i));
  }

  void says(const MessageSender& sender, Message message) {
    mailbox_.put(sender, std::move(message));
  }
  std::size_t take(double s) { return client_.take_answers(at(s)).size(); }
  std::uint64_t refused(const std::string& reason) {
    const auto refused = client_.statistics().refused;
    const auto count = refused.find(reason);
    return count == refused.end() ? 0 : count->second;
  }

  Mailbox mailbox_;
  CloudClient client_{"robot_1",
                      mailbox_,
                      read_cloud_client_config(
                          ConfigReader::from_string(default_config("robot")).section("client"))};
};

TEST_F(ForgedToARobot, ARogueLocalizerOfTheSameNameAndMapWithAHigherIncarnationIsNotFollowed) {
  constexpr Incarnation kRogue{99};
  for (int i = 0; i < 10; ++i) {
    says(kForeign, as_message(status_of("cloud_1", kRogue)));
    says(kForeign, as_message(answer_of("cloud_1", 5, kRogue)));
  }
  says(kHonest, as_message(answer_of("cloud_1", 5)));
  EXPECT_EQ(take(1.0), 1U) << "of the real one";
  EXPECT_EQ(client_.statistics().localizers_chosen, 1U) << "no restart was seen";
  EXPECT_EQ(refused("foreign_writer"), 20U);
  EXPECT_THAT(client_.take_events(), Contains(HasSubstr("another program is named cloud_1")));
}

TEST_F(ForgedToARobot, SpoofedAnswersThatAgreeWithEachOtherAreNotUsed) {
  for (std::uint32_t keyframe = 1; keyframe <= 5; ++keyframe) {
    says(kForeign, as_message(answer_of("cloud_1", keyframe)));
  }
  EXPECT_EQ(take(1.0), 0U);
  EXPECT_EQ(refused("foreign_writer"), 5U);
  says(kBeside, as_message(answer_of("cloud_1", 5)));
  EXPECT_EQ(take(1.1), 1U) << "who shares the localizer's computer is believed: not defended";
}

TEST_F(ForgedToARobot, AnOldAnswerThatIsReplayedIsGivenOnce) {
  const Message answer = as_message(answer_of("cloud_1", 5));
  says(kHonest, answer);
  EXPECT_EQ(take(1.0), 1U);
  for (const MessageSender& sender : {kHonest, kBeside}) {
    says(sender, answer);
    says(sender, as_message(answer_of("cloud_1", 4)));
  }
  EXPECT_LE(take(1.1), 1U) << "the one of keyframe 4 was not there before";
  LocalizationResult of_old_session = answer_of("cloud_1", 5);
  of_old_session.session = SessionNumber{0};
  says(kHonest, as_message(of_old_session));
  EXPECT_EQ(take(1.2), 0U);
  EXPECT_EQ(refused("other_session"), 1U);
}

// Its own name is no lie: that one is taken for what it says, where nobody has keys.
TEST_F(ForgedToARobot, ARogueLocalizerOfItsOwnNameIsOneMore) {
  LocalizerStatus idle = status_of("cloud_9");
  idle.load = 0.0;
  says(kForeign, as_message(idle));
  says(kForeign, as_message(answer_of("cloud_9", 5)));
  EXPECT_EQ(take(1.0), 0U) << "it was not asked";
  EXPECT_EQ(refused("other_localizer"), 1U);
  EXPECT_EQ(client_.statistics().localizer, "cloud_1");
}

}  // namespace
}  // namespace fleetloc
