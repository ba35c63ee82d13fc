#include "shared/transport/workarounds/route_cache.hpp"

#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint32_t kNear = 0x0a4d0002;  // 10.77.0.2
constexpr std::uint32_t kFar = 0x0a4e0002;   // 10.78.0.2

class RouteCacheTest : public testing::Test {
 protected:
  [[nodiscard]] bool has_route(std::uint32_t address) { return routes_.has_route(address, now_); }

  bool is_far_routed_ = false;
  int questions_ = 0;
  RouteCache routes_{[this](std::uint32_t address) {
    ++questions_;
    return address == kNear || is_far_routed_;
  }};
  RouteCache::Clock::time_point now_{seconds(1000)};
};

TEST_F(RouteCacheTest, AsksTheKernelOnceASecondForEachAddress) {
  for (int i = 0; i < 99; ++i) {
    EXPECT_TRUE(has_route(kNear));
    EXPECT_FALSE(has_route(kFar));
    now_ += milliseconds(10);
  }
  EXPECT_EQ(questions_, 2);
  now_ += milliseconds(10);
  EXPECT_TRUE(has_route(kNear));
  EXPECT_EQ(questions_, 3);
}

TEST_F(RouteCacheTest, SeesANewRouteAndTheEndOfOneWithinASecond) {
  EXPECT_FALSE(has_route(kFar));
  is_far_routed_ = true;
  now_ += seconds(1);
  EXPECT_TRUE(has_route(kFar));
  is_far_routed_ = false;
  now_ += seconds(1);
  EXPECT_FALSE(has_route(kFar));
}

TEST_F(RouteCacheTest, StaysSmallWhateverIsAnnounced) {
  for (std::uint32_t address = 0; address < 5000; ++address) EXPECT_FALSE(has_route(address));
  EXPECT_FALSE(has_route(0));
  EXPECT_EQ(questions_, 5001) << "the first was forgotten";
}

TEST(RouteCache, AnswersManyThreadsAlike) {
  RouteCache routes([](std::uint32_t address) { return address % 2 == 0; });
  std::vector<std::jthread> threads;
  threads.reserve(4);
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      RouteCache::Clock::time_point now{seconds(1000)};
      for (std::uint32_t n = 0; n < 10'000; ++n, now += milliseconds(1)) {
        EXPECT_EQ(routes.has_route(n % 10, now), n % 2 == 0);
      }
    });
  }
}

TEST(RouteCache, AsksTheRealKernel) {
  EXPECT_TRUE(RouteCache().has_route(0x7f000001, RouteCache::Clock::now()));
}

}  // namespace
}  // namespace fleetloc
