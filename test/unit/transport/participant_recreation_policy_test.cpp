#include "shared/transport/workarounds/participant_recreation_policy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

const InterfaceAddresses kHome{{.interface_index = 2, .address = "10.0.0.1"}};
const InterfaceAddresses kAway{{.interface_index = 2, .address = "10.9.0.7"}};
const InterfaceAddresses kHomeAnew{{.interface_index = 3, .address = "10.0.0.1"}};

/// A participant that is made whenever that is due, unless it `fails`.
class ParticipantRecreationPolicyTest : public testing::Test {
 protected:
  ParticipantRecreationPolicyTest() { policy_.made({.addresses = kHome, .peers = {}}, now_); }

  /// Looks every 50 ms, as long as `duration`. How often a participant was made.
  int watch(std::chrono::milliseconds duration, const InterfaceAddresses& addresses) {
    int recreations = 0;
    for (const auto end = now_ + duration; now_ < end; now_ += milliseconds(50)) {
      if (hears_) ++heard_;
      policy_.observe({.addresses = addresses, .heard = heard_, .is_expecting = expects_}, now_);
      const auto due = policy_.due(now_);
      if (!due) continue;
      reason_ = *due;
      ++recreations;
      if (fails_) {
        policy_.failed(now_);
      } else {
        policy_.made({.addresses = addresses, .peers = policy_.peers()}, now_);
      }
    }
    return recreations;
  }

  ParticipantRecreationPolicy policy_{{.lease = seconds(20), .announcements = seconds(3)}};
  ParticipantRecreationPolicy::Time now_{seconds(1000)};
  std::uint64_t heard_ = 0;
  bool hears_ = false;
  bool expects_ = true;
  bool fails_ = false;
  std::string reason_;
};

TEST_F(ParticipantRecreationPolicyTest, KeepsAParticipantWhoseNetworkStays) {
  hears_ = true;
  EXPECT_EQ(watch(std::chrono::hours(1), kHome), 0);
}

TEST_F(ParticipantRecreationPolicyTest, MakesOneNowAndThenWhereNobodyHasEverBeenHeard) {
  EXPECT_EQ(watch(seconds(29), kHome), 0);
  EXPECT_EQ(watch(seconds(2), kHome), 1);
  EXPECT_LT(watch(std::chrono::hours(1), kHome), 12);
}

TEST_F(ParticipantRecreationPolicyTest, KeepsAnIdleParticipantThatExpectsNobody) {
  expects_ = false;
  EXPECT_EQ(watch(std::chrono::hours(1), kHome), 0);
  hears_ = true;
  expects_ = true;
  watch(seconds(5), kHome);
  hears_ = false;
  watch(seconds(25), kHome);
  expects_ = false;  // who spoke has left, or his lease is over
  EXPECT_EQ(watch(std::chrono::hours(1), kHome), 0);
  EXPECT_EQ(watch(milliseconds(200), kAway), 1);
  EXPECT_EQ(watch(seconds(10), kAway), 1) << "a change asks for one more try";
  EXPECT_EQ(watch(std::chrono::hours(1), kAway), 0);
}

TEST_F(ParticipantRecreationPolicyTest, MakesOneSoonAfterAnotherAddressAndOnlyOne) {
  hears_ = true;
  watch(seconds(5), kHome);
  EXPECT_EQ(watch(milliseconds(200), kAway), 1);
  EXPECT_THAT(reason_, HasSubstr("10.9.0.7"));
  EXPECT_EQ(watch(seconds(60), kAway), 0);
}

TEST_F(ParticipantRecreationPolicyTest,
       TriesOnceMoreAfterTwoAnnouncementsWhenNobodyIsHeardAfterAChange) {
  hears_ = true;
  watch(seconds(5), kHome);
  hears_ = false;
  EXPECT_EQ(watch(milliseconds(200), kAway), 1);
  EXPECT_EQ(watch(milliseconds(5700), kAway), 0);
  EXPECT_EQ(watch(milliseconds(500), kAway), 1);
  EXPECT_EQ(watch(seconds(29), kAway), 0);
  EXPECT_EQ(watch(seconds(2), kAway), 1);
}

TEST_F(ParticipantRecreationPolicyTest, MakesOneWhenTheSameAddressIsBackHoweverShortlyItWasGone) {
  watch(seconds(5), kHome);
  EXPECT_EQ(watch(milliseconds(50), {}), 0);
  EXPECT_TRUE(policy_.is_cut_off());
  EXPECT_EQ(watch(milliseconds(200), kHome), 1);
  EXPECT_FALSE(policy_.is_cut_off());
}

TEST_F(ParticipantRecreationPolicyTest, MakesOneWhenAnAddressWasGoneThatNobodySawMissing) {
  hears_ = true;
  watch(seconds(5), kHome);
  policy_.lost(kAway, now_);
  EXPECT_EQ(watch(seconds(5), kHome), 0);
  policy_.lost(kHome, now_);
  EXPECT_EQ(watch(seconds(5), kHome), 1);
}

TEST_F(ParticipantRecreationPolicyTest, MakesOneForAnInterfaceThatWasMadeAnewWithTheSameAddress) {
  hears_ = true;
  watch(seconds(5), kHome);
  EXPECT_EQ(watch(seconds(5), kHomeAnew), 1);
}

TEST_F(ParticipantRecreationPolicyTest, MakesNoneWithoutANetwork) {
  hears_ = true;
  watch(seconds(5), kHome);
  hears_ = false;
  EXPECT_EQ(watch(std::chrono::hours(1), {}), 0);
}

TEST_F(ParticipantRecreationPolicyTest, WaitsLongerAfterEachFailure) {
  watch(seconds(5), kHome);
  fails_ = true;
  const int attempts = watch(std::chrono::hours(1), kAway);
  EXPECT_GT(attempts, 5);
  EXPECT_LT(attempts, 130);  // every half minute
  fails_ = false;
  hears_ = true;
  EXPECT_EQ(watch(seconds(33), kAway), 1);
  EXPECT_EQ(watch(std::chrono::hours(1), kAway), 0);
}

TEST_F(ParticipantRecreationPolicyTest, MakesOneASecondAtMostWhileAddressesComeAndGo) {
  watch(seconds(5), kHome);
  int recreations = 0;
  for (int i = 0; i < 100; ++i) {
    recreations += watch(milliseconds(200), kAway);
    recreations += watch(milliseconds(200), kHome);
  }
  EXPECT_GT(recreations, 20);
  EXPECT_LE(recreations, 41);  // in 40 s
}

ResolvedPeers server_at(const std::string& address) {
  return {
      {.peer = {.host = "discovery", .port = 11811, .server_prefix = "44"}, .address = address}};
}

TEST_F(ParticipantRecreationPolicyTest, MakesOneWhenANamedPeerIsElsewhereButNotWhenItIsNotFound) {
  hears_ = true;
  policy_.found(server_at("10.0.0.9"), now_);
  EXPECT_EQ(watch(seconds(5), kHome), 1);
  EXPECT_THAT(reason_, HasSubstr("discovery at 10.0.0.9"));
  policy_.found({}, now_);
  policy_.found(server_at("10.0.0.9"), now_);
  EXPECT_EQ(watch(seconds(5), kHome), 0);
  policy_.found(server_at("10.0.0.8"), now_);
  EXPECT_EQ(watch(seconds(5), kHome), 1);
}

TEST_F(ParticipantRecreationPolicyTest, LooksPeersUpMoreOftenWhileNothingIsHeard) {
  const auto lookups = [&](int count) {
    int due = 0;
    for (int i = 0; i < count; ++i) {
      watch(milliseconds(50), kHome);
      due += policy_.wants_lookup(now_) ? 1 : 0;
    }
    return due;
  };
  EXPECT_GE(lookups(20 * 10), 9) << "at the start";
  hears_ = true;
  EXPECT_LE(lookups(20 * 60), 7);
  hears_ = false;
  EXPECT_LE(lookups(20 * 10), 2) << "no longer than between two statuses";
  EXPECT_GE(lookups(20 * 60), 50);
}

TEST_F(ParticipantRecreationPolicyTest, MakesOneAfterItsDiscoveryServerWasStartedAgain) {
  hears_ = true;
  watch(seconds(5), kHome);
  policy_.server_restarted();
  EXPECT_EQ(watch(seconds(60), kHome), 1);
  EXPECT_THAT(reason_, HasSubstr("discovery server"));
}

TEST_F(ParticipantRecreationPolicyTest, MakesOneAfterLongSilenceAndThenMoreAndMoreSeldom) {
  hears_ = true;
  watch(seconds(5), kHome);
  hears_ = false;
  EXPECT_EQ(watch(seconds(29), kHome), 0);
  EXPECT_EQ(watch(seconds(2), kHome), 1);
  EXPECT_THAT(reason_, HasSubstr("nothing has been heard for 30 s"));
  EXPECT_EQ(watch(seconds(59), kHome), 0);
  EXPECT_EQ(watch(seconds(2), kHome), 1);
  const int more = watch(std::chrono::hours(1), kHome);
  EXPECT_GT(more, 3);
  EXPECT_LT(more, 10);
  hears_ = true;
  watch(seconds(1), kHome);
  hears_ = false;
  EXPECT_EQ(watch(seconds(32), kHome), 1);
}

}  // namespace
}  // namespace fleetloc
