// A localizer's computer is often in several networks, of which a robot reaches one.
#include <optional>

#include <gtest/gtest.h>

#include "shared/transport/network_addresses.hpp"
#include "test/system/network_namespace.hpp"

namespace fleetloc {
namespace {

class ReachableAddress : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto reason = NetworkNamespace::why_impossible()) GTEST_SKIP() << *reason;
    robots_.emplace();
    clouds_.emplace();
    network_.emplace(true);
    network_->plug_in(*robots_, "10.77.0.1");
    network_->plug_in(*clouds_, "10.77.0.2");
    robots_->ip("route delete default");
  }

  std::optional<NetworkNamespace> robots_, clouds_;
  std::optional<SwitchedNetwork> network_;
};

TEST_F(ReachableAddress, HasARoute) {
  const auto inside = robots_->enter();
  EXPECT_TRUE(has_route("10.77.0.2"));
  EXPECT_TRUE(has_route("127.0.0.1"));
  EXPECT_FALSE(has_route("10.78.0.2"));
  EXPECT_FALSE(has_route("nonsense"));
}

}  // namespace
}  // namespace fleetloc
