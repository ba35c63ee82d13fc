#include "shared/transport/workarounds/peer_address_filter.hpp"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::seconds;

constexpr GuidPrefix kLocalizer{1};
constexpr GuidPrefix kOtherPeer{2};
constexpr std::uint32_t kNearAddress = 0x0a4d0002;  // 10.77.0.2
constexpr std::uint32_t kFarAddress = 0x0a4e0002;   // 10.78.0.2
constexpr std::uint32_t kBridge = 0xac110001;       // 172.17.0.1
constexpr std::uint32_t kPort = 7411;

/// A localizer with three addresses.
class PeerAddressFilterTest : public testing::Test {
 protected:
  PeerAddressFilterTest() {
    for (const std::uint32_t address : {kNearAddress, kFarAddress, kBridge}) {
      known_.announced(kLocalizer, {address, kPort}, now_);
    }
  }

  [[nodiscard]] bool is_redundant(std::uint32_t address) const {
    return known_.is_redundant({address, kPort}, destinations_, now_);
  }

  PeerAddressFilter known_;
  std::vector<PeerAddressFilter::Locator> destinations_{
      {kNearAddress, kPort}, {kFarAddress, kPort}, {kBridge, kPort}};
  PeerAddressFilter::Time now_{seconds(1000)};
};

TEST_F(PeerAddressFilterTest, AreAllOfUseUntilTheParticipantIsHeard) {
  for (const std::uint32_t address : {kNearAddress, kFarAddress, kBridge})
    EXPECT_FALSE(is_redundant(address));
  known_.heard(kLocalizer, kNearAddress, now_);
  EXPECT_FALSE(is_redundant(kNearAddress));
  EXPECT_TRUE(is_redundant(kFarAddress));
  EXPECT_TRUE(is_redundant(kBridge));
  EXPECT_FALSE(known_.is_redundant({kFarAddress, kPort + 2}, destinations_, now_))
      << "somebody else's port";
}

TEST_F(PeerAddressFilterTest, AreAllOfUseAgainWhenItIsSilent) {
  known_.heard(kLocalizer, kNearAddress, now_);
  now_ += seconds(20);
  EXPECT_FALSE(is_redundant(kFarAddress));
}

TEST_F(PeerAddressFilterTest, FollowTheParticipantToAnotherOfItsNetworks) {
  known_.heard(kLocalizer, kNearAddress, now_);
  now_ += seconds(1);
  known_.heard(kLocalizer, kFarAddress, now_);
  EXPECT_TRUE(is_redundant(kNearAddress));
  EXPECT_FALSE(is_redundant(kFarAddress));
}

TEST_F(PeerAddressFilterTest, AreAllOfUseWhereTheSourceIsTranslated) {
  known_.heard(kLocalizer, 0xc0a80001, now_);
  for (const std::uint32_t address : {kNearAddress, kFarAddress, kBridge})
    EXPECT_FALSE(is_redundant(address));
}

TEST_F(PeerAddressFilterTest, ThatTwoAnnounceAreOfUseUntilBothAreHeardElsewhere) {
  known_.announced(kOtherPeer, {kBridge, kPort}, now_);  // each computer has such a bridge
  known_.heard(kLocalizer, kNearAddress, now_);
  EXPECT_FALSE(is_redundant(kBridge)) << "the other one has no other address";
  EXPECT_TRUE(is_redundant(kFarAddress));
  known_.announced(kOtherPeer, {kFarAddress, kPort}, now_);
  known_.heard(kOtherPeer, kFarAddress, now_);
  EXPECT_TRUE(is_redundant(kBridge));
  EXPECT_FALSE(is_redundant(kFarAddress));
}

// A discovery server is spoken to at the address that its name has.
TEST_F(PeerAddressFilterTest, AreOfUseWhereADatagramGoesToNoOther) {
  known_.heard(kLocalizer, kNearAddress, now_);
  destinations_ = {{kFarAddress, kPort}};
  EXPECT_FALSE(is_redundant(kFarAddress));
  destinations_ = {{kFarAddress, kPort}, {kNearAddress, kPort + 2}};
  EXPECT_FALSE(is_redundant(kFarAddress));
}

TEST_F(PeerAddressFilterTest, ForgetWhoIsGone) {
  known_.announced(kOtherPeer, {kBridge, kPort}, now_);
  now_ += seconds(90);
  known_.heard(kLocalizer, kNearAddress, now_);
  EXPECT_TRUE(is_redundant(kBridge));
}

TEST_F(PeerAddressFilterTest, AreBounded) {
  for (std::uint32_t i = 0; i < 100'000; ++i) {
    GuidPrefix prefix{};
    prefix[0] = 9;
    for (unsigned int byte = 0; byte < 4; ++byte) {
      prefix[4 + byte] = static_cast<std::uint8_t>(i >> (8 * byte));
    }
    known_.announced(prefix, {i, kPort}, now_);
    known_.heard(prefix, i, now_);
    ASSERT_FALSE(known_.is_redundant({i, kPort}, destinations_, now_));
  }
}

TEST_F(PeerAddressFilterTest, MayBeAskedWhileOthersAreHeardAndAnnounced) {  // for ThreadSanitizer
  known_.heard(kLocalizer, kNearAddress, now_);
  const std::jthread hears([&] {
    for (int i = 0; i < 1000; ++i) known_.heard(kLocalizer, kNearAddress, now_);
  });
  const std::jthread announces([&] {
    for (std::uint32_t i = 0; i < 1000; ++i) known_.announced(kOtherPeer, {i, kPort}, now_);
  });
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(is_redundant(kFarAddress));
}

}  // namespace
}  // namespace fleetloc
