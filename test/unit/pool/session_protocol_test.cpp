#include "cloud/pool/session_protocol.hpp"

#include <gtest/gtest.h>

#include "shared/wire/status_codec.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

using Change = SessionProtocol::Change;

RobotSession session_of(const RobotId& robot, double start_s = 1.0) {
  RobotSession session;
  session.robot = robot;
  session.session = SessionNumber{static_cast<std::uint32_t>(start_s)};
  session.start_stamp = at(start_s);
  session.localizer = "localizer";
  session.incarnation = Incarnation{3};
  return session;
}

Submap submap_of(const RobotSession& session, std::uint32_t number) {
  Submap submap;
  submap.robot = session.robot;
  submap.session = session.session;
  submap.incarnation = session.incarnation;
  submap.number = SampleNumber{number};
  submap.keyframes.emplace_back().id = KeyframeId{number};
  return submap;
}

class SessionProtocolTest : public testing::Test {
 protected:
  std::size_t sent_answers(double s) {
    return static_cast<std::size_t>(std::ranges::count_if(
        protocol_.outgoing(at(s), 0.0, report_),
        [](const auto& outgoing) { return outgoing.message.topic == Topic::kLocalization; }));
  }
  static SessionProtocol::Config config() {
    return {
        .max_sessions = 2,
        .idle_session_s = 120.0,
        .session_request_interval_s = 1.0,
        .status = {.interval_s = 10.0, .min_interval_s = 1.0},
        .answers = {.retransmission = {.max_interval_s = 1.0,
                                       .min_interval_s = 0.2,
                                       .full_rate_loss = 0.3},
                    .repeated_for_s = 30.0,
                    .max_payload_bytes = 480,
                    .budget = {.max_bytes_per_s = 2000.0,
                               .max_bytes_per_s_high_loss = 4000.0,
                               .high_loss = 0.75,
                               .min_bytes_per_s = 300.0,
                               .burst_bytes = 2000.0,
                               .max_queueing_s = 0.2,
                               .increase_bytes_per_s2 = 100.0,
                               .decrease = 0.7,
                               .shortest_memory_s = 120.0,
                               .unmeasured_bytes_per_s = 1200.0,
                               .measured_for_s = 10.0}},
        .sessions = {.settling_s = 5.0, .silence_s = 20.0, .max_robots = 10},
        .admission = {.max_load = 0.8,
                      .open_load = 0.6,
                      .max_wait_s = 0.5,
                      .open_wait_s = 0.25,
                      .new_for_s = 5.0,
                      .session_load = 0.1},
        .draining = {
            .max_s = 10.0, .silence_s = 3.0, .status = {.interval_s = 0.5, .min_interval_s = 0.1}}};
  }

  /// The statuses that are sent at that time.
  std::vector<LocalizerStatus> statuses(double s, double load = 0.0) {
    std::vector<LocalizerStatus> statuses;
    for (const auto& outgoing : protocol_.outgoing(at(s), load, report_)) {
      if (outgoing.message.topic != Topic::kLocalizerStatus) continue;
      statuses.push_back(decode_localizer_status(outgoing.message.payload).value());
    }
    return statuses;
  }

  SessionProtocol protocol_{
      {.name = "localizer", .incarnation = Incarnation{3}, .map_hash = MapHash{}}, config()};
  PoolReport report_{2};
};

TEST_F(SessionProtocolTest, ASessionIsOpenedOnceAndReplacedByALaterOne) {
  EXPECT_EQ(protocol_.announced(session_of("a"), at(0)), Change::kOpened);
  EXPECT_EQ(protocol_.announced(session_of("a"), at(1)), Change::kNone);
  EXPECT_EQ(protocol_.announced(session_of("a", 2.0), at(2)), Change::kReplaced);
  EXPECT_EQ(protocol_.announced(session_of("a", 1.0), at(3)).error(),
            PoolRefusal::kOutdatedSession);
  EXPECT_EQ(protocol_.announced(session_of("a", 1.0), at(9)).error(),
            PoolRefusal::kConflictingSession);
}

TEST_F(SessionProtocolTest, ANewStartCountsUntilTheRobotIsLocalized) {
  RobotSession session = session_of("a");
  protocol_.announced(session, at(0)).value();
  session.start = MapOdomEstimate{};
  EXPECT_EQ(protocol_.announced(session, at(1)), Change::kNewStart);
  EXPECT_EQ(protocol_.announced(session, at(2)), Change::kNone) << "the same one";
  LocalizationResult answer;
  answer.status = LocalizationStatus::kLocalized;
  protocol_.answer("a", answer, std::nullopt);
  session.start->p_odom.x() = 1.0;
  EXPECT_EQ(protocol_.announced(session, at(3)), Change::kNone);
}

TEST_F(SessionProtocolTest, ARobotThatGoesElsewhereLeavesOnlyIfItWasHere) {
  RobotSession elsewhere = session_of("a");
  elsewhere.localizer = "other";
  EXPECT_EQ(protocol_.announced(elsewhere, at(0)), Change::kNone);
  protocol_.announced(session_of("a"), at(1)).value();
  EXPECT_EQ(protocol_.announced(elsewhere, at(2)), Change::kLeft);
}

TEST_F(SessionProtocolTest, ExpectsTheRobotsThatItServesAndThoseThatMayCome) {
  RobotSession elsewhere = session_of("may_come");
  elsewhere.localizer = "other";
  protocol_.announced(elsewhere, at(0)).value();
  protocol_.announced(session_of("is_here"), at(0)).value();
  EXPECT_EQ(protocol_.take_expected(), (std::vector<RobotId>{"may_come", "is_here"}));
  EXPECT_TRUE(protocol_.take_expected().empty());
  EXPECT_EQ(protocol_.sessions(), 1);
}

TEST_F(SessionProtocolTest, RefusesMoreSessionsThanItMayHave) {
  protocol_.announced(session_of("a"), at(0)).value();
  protocol_.announced(session_of("b"), at(0)).value();
  EXPECT_EQ(protocol_.announced(session_of("c"), at(0)).error(), PoolRefusal::kTooManySessions);
  EXPECT_FALSE(protocol_.submap(header_of(submap_of(session_of("c"), 0)), at(0)).has_value());
  EXPECT_EQ(sent_answers(0.1), 0) << "it is not asked for a session that would not be taken";
}

TEST_F(SessionProtocolTest, TakesEachSubmapOfTheSessionOnce) {
  const RobotSession session = session_of("a");
  EXPECT_EQ(protocol_.submap(header_of(submap_of(session, 0)), at(0)).error(),
            PoolRefusal::kUnknownSession);
  EXPECT_EQ(sent_answers(0.1), 1) << "it is asked for its session";
  protocol_.announced(session, at(1)).value();
  const SubmapHeader first = header_of(submap_of(session, 1));
  EXPECT_TRUE(protocol_.submap(first, at(1)).has_value());
  EXPECT_TRUE(protocol_.submap(first, at(1)).has_value()) << "it is not stored yet";
  protocol_.store(first, at(0));
  EXPECT_EQ(protocol_.submap(header_of(submap_of(session, 1)), at(1)).error(),
            PoolRefusal::kSeenBefore);
  Submap earlier = submap_of(session, 2);
  earlier.incarnation = Incarnation{2};
  EXPECT_EQ(protocol_.submap(header_of(earlier), at(1)).error(), PoolRefusal::kOtherIncarnation);
}

TEST_F(SessionProtocolTest, TellsItsStatusSoonAfterAChangeAndOtherwiseSeldom) {
  const auto statuses = [&](double from_s, double to_s, double load) {
    std::size_t count = 0;
    for (double s = from_s; s < to_s; s += 0.1) {
      for (const auto& outgoing : protocol_.outgoing(at(s), load, report_)) {
        count += outgoing.message.topic == Topic::kLocalizerStatus ? 1 : 0;
      }
    }
    return count;
  };
  EXPECT_EQ(statuses(0.0, 9.9, 0.0), 1);
  EXPECT_EQ(statuses(9.9, 20.0, 0.05), 1) << "a load that hardly changes";
  EXPECT_EQ(statuses(20.0, 20.1, 0.5), 1) << "one that changes much";
  protocol_.announced(session_of("a"), at(20.1)).value();
  EXPECT_EQ(statuses(20.1, 20.9, 0.5), 0) << "not so soon";
  EXPECT_EQ(statuses(20.9, 22.0, 0.5), 1) << "a session more";
  EXPECT_EQ(statuses(22.0, 31.0, 0.5), 0);
}

TEST_F(SessionProtocolTest, ARobotIsIdleOnceItIsSilent) {
  const RobotSession session = session_of("a");
  protocol_.announced(session, at(0)).value();
  EXPECT_TRUE(protocol_.idle(at(119)).empty());
  EXPECT_EQ(protocol_.idle(at(121)).size(), 1);
  RobotStatus status;
  status.robot = "a";
  status.session = session.session;
  status.start_stamp = session.start_stamp;
  EXPECT_TRUE(protocol_.status(status, at(121)).has_value());
  EXPECT_TRUE(protocol_.idle(at(122)).empty());
  EXPECT_EQ(protocol_.end("a"), at(121));
  EXPECT_EQ(protocol_.status(status, at(123)).error(), PoolRefusal::kUnknownSession);
}

TEST_F(SessionProtocolTest, ADrainingLocalizerSaysSoAtOnceAndAgainAndTakesNoRobots) {
  ASSERT_EQ(statuses(0.0).size(), 1);
  protocol_.drain(at(0.1));
  const auto first = statuses(0.1);
  ASSERT_EQ(first.size(), 1);
  EXPECT_TRUE(first[0].draining);
  EXPECT_FALSE(first[0].accepting);
  int repeated = 0;
  for (int ms = 110; ms <= 2100; ms += 10) {
    repeated += static_cast<int>(statuses(1e-3 * ms).size());
  }
  EXPECT_EQ(repeated, 4);
}

TEST_F(SessionProtocolTest, ADrainingLocalizerWaitsForItsRobotsButNotForLong) {
  EXPECT_TRUE(protocol_.announced(session_of("a"), at(0.0)));
  EXPECT_TRUE(protocol_.announced(session_of("b"), at(0.0)));
  EXPECT_TRUE(protocol_.to_leave(at(0.0)).empty()) << "it does not drain";
  protocol_.drain(at(1.0));
  EXPECT_EQ(protocol_.to_leave(at(1.0)), (std::vector<RobotId>{"a", "b"}));
  RobotSession left = session_of("a");
  left.localizer = "other";
  EXPECT_EQ(protocol_.announced(left, at(2.0)).value(), Change::kLeft);
  protocol_.end("a");
  EXPECT_EQ(protocol_.to_leave(at(2.0)), std::vector<RobotId>{"b"});
  EXPECT_TRUE(protocol_.to_leave(at(3.5)).empty()) << "nothing was heard of it";
  for (std::uint32_t i = 0; i < 40; ++i) {
    static_cast<void>(
        protocol_.submap(header_of(submap_of(session_of("b"), i)), at(1.0 + 0.5 * i)));
    const double s = 1.0 + 0.5 * i;
    EXPECT_EQ(protocol_.to_leave(at(s)).size(), s <= 11.0 ? 1 : 0) << s;
  }
}

TEST_F(SessionProtocolTest, AcceptsNoFurtherRobotsWhileItHasTooMuchToDo) {
  EXPECT_TRUE(protocol_.announced(session_of("a"), at(0.0)));
  EXPECT_TRUE(statuses(10.0, 0.5).at(0).accepting);
  EXPECT_FALSE(statuses(12.0, 0.9).at(0).accepting);
  EXPECT_TRUE(protocol_.submap(header_of(submap_of(session_of("a"), 0)), at(13.0)))
      << "still served";
  EXPECT_TRUE(statuses(14.0, 0.3).at(0).accepting);
}

}  // namespace
}  // namespace fleetloc
