#include "shared/transport/ros2/arrival_queue.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kAtOnce{0};
constexpr std::chrono::seconds kPatience{30};  // only a broken queue takes that long

Ros2Sample sample(std::size_t topic, std::uint8_t number) {
  return {.topic = topic, .payload = {number}, .arrival = {}};
}

/// All that waits, as topic and number.
std::vector<std::pair<std::size_t, int>> taken(ArrivalQueue& queue) {
  std::vector<std::pair<std::size_t, int>> taken;
  while (const auto next = queue.pop({}, kAtOnce)) {
    taken.emplace_back(next->topic, next->payload.front());
  }
  return taken;
}

using Taken = std::vector<std::pair<std::size_t, int>>;

TEST(ArrivalQueue, GivesWhatCameFirstWhateverItsTopic) {
  ArrivalQueue queue({3, 3});
  queue.push(sample(1, 1));
  queue.push(sample(0, 2));
  queue.push(sample(1, 3));
  EXPECT_EQ(taken(queue), (Taken{{1, 1}, {0, 2}, {1, 3}}));
}

TEST(ArrivalQueue, DropsTheOldestOfTheTopicThatIsFull) {
  ArrivalQueue queue({2, 1});
  queue.push(sample(1, 1));
  for (std::uint8_t number = 2; number <= 5; ++number) queue.push(sample(0, number));
  EXPECT_EQ(taken(queue), (Taken{{1, 1}, {0, 4}, {0, 5}}));
  EXPECT_EQ(queue.dropped(0), 2);
  EXPECT_EQ(queue.dropped(1), 0);
}

TEST(ArrivalQueue, EndsItsWaitWhenThereIsNothing) {
  ArrivalQueue queue({1});
  EXPECT_FALSE(queue.pop({}, 1ms));
}

TEST(ArrivalQueue, EndsItsWaitWhenASampleComes) {
  ArrivalQueue queue({1});
  const std::jthread driver([&] { queue.push(sample(0, 7)); });
  const auto next = queue.pop({}, kPatience);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->payload, Bytes{7});
}

TEST(ArrivalQueue, EndsItsWaitWhenAStopIsRequested) {
  ArrivalQueue queue({1});
  std::stop_source stop;
  const auto begin = std::chrono::steady_clock::now();
  const std::jthread user([&] { stop.request_stop(); });
  EXPECT_FALSE(queue.pop(stop.get_token(), kPatience));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, kPatience);
}

TEST(ArrivalQueue, GivesNothingMoreOnceAStopIsRequested) {
  ArrivalQueue queue({1});
  queue.push(sample(0, 1));
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(queue.pop(stop.get_token(), kAtOnce));
}

}  // namespace
}  // namespace fleetloc
