// A link costs the same in a replay as over DDS: the same link and the same times of sending, and
// what arrives is compared in its distribution. It cannot be the same sample by sample, because
// discovery uses the link of DDS as well.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "shared/link/datagrams.hpp"
#include "shared/link/memory_network.hpp"
#include "test/transport/test_network.hpp"
#include "test/transport/wire_samples.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kSamples = 400;
constexpr milliseconds kSpacing{30};
constexpr milliseconds kDrained{3000};     // later than nearly any sample
constexpr double kSchedulingDelay = 0.01;  // [s] that threads of a busy machine may add

struct Delivery {
  std::uint32_t number;
  double latency_s;
};

struct Setting {
  const char* name;
  LinkDirection uplink;
  std::size_t rows;  ///< of the samples
  std::size_t datagrams;
};

const std::vector<Setting>& settings() {
  static const std::vector<Setting> settings{
      {"jitter", {.delay_s = 0.02, .jitter_s = 0.3}, 0, 1},
      {"bursts, reordering and duplicates",
       {.loss = 0.3,
        .delay_s = 0.02,
        .burst_length = 3.0,
        .jitter_s = 0.06,
        .reordering = 0.2,
        .reordering_delay_s = 0.15,
        .duplication = 0.3},
       0,
       1},
      {"jitter of fragments", {.loss = 0.1, .delay_s = 0.02, .jitter_s = 0.03}, 800, 2},
      {"a queue",
       {.loss = 0.1,
        .delay_s = 0.02,
        .rate_bytes_per_s = 17'000.0,
        .queue_bytes = 15'000,
        .jitter_s = 0.06},
       300,
       1}};
  return settings;
}

/// Of several instances in turn: their writer is one, and so is their order. Of those that arrive
/// together, a reader of DDS gives out one instance after the other.
constexpr std::uint32_t kInstances = 4;

Message sample(std::uint32_t number, std::size_t rows) {
  return numbered_submap(number, "robot_" + std::to_string(number % kInstances), rows);
}

/// Samples 1, 2, ... over DDS.
class DdsRun {
 public:
  explicit DdsRun(const Setting& setting)
      : rows_(setting.rows),
        robot_(on_loopback(network_.domain(),
                           ChannelRole::kRobot,
                           "robot_1",
                           LinkConfig{.uplink = setting.uplink, .downlink = {}, .seed = 1})),
        cloud_(on_loopback(network_.domain(), ChannelRole::kCloud, "cloud_1")) {}

  /// Until the ends know each other.
  bool is_ready() {
    return receives(
        cloud_,
        [&] { robot_.send("cloud_1", numbered_submap(0), {}); },
        [](const Message&) { return true; });
  }

  void send_all() {
    take_until(Clock::now() + kDrained);
    start_ = Clock::now();
    for (std::uint32_t number = 1; number <= kSamples; ++number) {
      take_until(start_ + number * kSpacing);
      sent_.push_back(Clock::now() - start_);
      robot_.send("cloud_1", sample(number, rows_), {});
    }
    take_until(Clock::now() + kDrained);
  }

  [[nodiscard]] const std::vector<Duration>& sent() const { return sent_; }
  [[nodiscard]] const std::vector<Delivery>& delivered() const { return delivered_; }

 private:
  void take_until(Clock::time_point end) {
    while (Clock::now() < end) {
      const auto left = std::chrono::ceil<milliseconds>(end - Clock::now());
      if (!cloud_.wait_for_message(left)) continue;
      const Duration now = Clock::now() - start_;
      for (const Message& message : cloud_.receive({})) {
        const std::uint32_t number = number_of(message);
        if (number == 0) continue;
        delivered_.push_back({number, to_seconds(now - sent_.at(number - 1))});
      }
    }
  }

  std::size_t rows_;
  TestNetwork network_;
  DdsChannel robot_, cloud_;
  Clock::time_point start_;
  std::vector<Duration> sent_;
  std::vector<Delivery> delivered_;
};

/// The same samples at the same times in memory.
std::vector<Delivery> replayed(const Setting& setting, const std::vector<Duration>& sent) {
  constexpr Timestamp kStart{std::chrono::seconds(100)};
  constexpr std::chrono::microseconds kStep{200};
  MemoryNetwork network({.uplink = setting.uplink, .downlink = {}, .seed = 1});
  const auto robot = network.join_robot("robot_1");
  const auto cloud = network.join_cloud("cloud_1");
  std::vector<Delivery> delivered;
  std::size_t next = 0;
  for (Duration now{}; now < sent.back() + kDrained; now += kStep) {
    for (; next < sent.size() && sent[next] <= now; ++next) {
      const auto number = static_cast<std::uint32_t>(next + 1);
      robot->send("cloud_1", sample(number, setting.rows), kStart + sent[next]);
    }
    for (const Message& message : cloud->receive(kStart + now)) {
      const std::uint32_t number = number_of(message);
      delivered.push_back({number, to_seconds(now - sent.at(number - 1))});
    }
  }
  return delivered;
}

std::vector<double> latencies(const std::vector<Delivery>& delivered) {
  std::vector<double> values;
  values.reserve(delivered.size());
  for (const Delivery& one : delivered) values.push_back(one.latency_s);
  return values;
}

/// From each number that is delivered to the next.
std::vector<double> steps(const std::vector<Delivery>& delivered) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(delivered.size());
  for (const Delivery& one : delivered) numbers.push_back(one.number);
  std::ranges::sort(numbers);
  std::vector<double> values;
  for (std::size_t i = 1; i < numbers.size(); ++i) values.push_back(numbers[i] - numbers[i - 1]);
  return values;
}

/// The statistic of Kolmogorov and Smirnov for two samples: of the same distribution, it is above
/// 2.2 once in 10,000 times, and more seldom if values repeat.
/// @param slack  values of `a` may be larger by up to that
double difference(std::vector<double> a, std::vector<double> b, double slack = 0.0) {
  std::ranges::sort(a);
  std::ranges::sort(b);
  const auto share_up_to = [](const std::vector<double>& sorted, double value) {
    const auto end = std::ranges::upper_bound(sorted, value);
    return static_cast<double>(end - sorted.begin()) / static_cast<double>(sorted.size());
  };
  double distance = 0.0;
  for (const double value : a) {
    distance = std::max(distance, share_up_to(a, value) - share_up_to(b, value));
  }
  for (const double value : b) {
    distance = std::max(distance, share_up_to(b, value) - share_up_to(a, value + slack));
  }
  const auto n = static_cast<double>(a.size());
  const auto m = static_cast<double>(b.size());
  return distance * std::sqrt(n * m / (n + m));
}

double share(const std::vector<Delivery>& delivered) {
  return static_cast<double>(delivered.size()) / kSamples;
}

/// Within each instance.
bool is_ascending(const std::vector<Delivery>& delivered) {
  std::array<std::uint32_t, kInstances> last{};
  for (const Delivery& one : delivered) {
    std::uint32_t& number = last.at(one.number % kInstances);
    if (one.number <= number) return false;
    number = one.number;
  }
  return true;
}

void expect_agreement(const Setting& setting) {
  const std::size_t bytes = sample(1, setting.rows).payload.size();
  ASSERT_EQ(datagram_sizes(bytes).size(), setting.datagrams);
  DdsRun dds(setting);
  ASSERT_TRUE(dds.is_ready());
  dds.send_all();
  const std::vector<Delivery>& delivered = dds.delivered();
  const std::vector<Delivery> replay = replayed(setting, dds.sent());
  EXPECT_NEAR(share(delivered), share(replay), 0.15);
  EXPECT_TRUE(is_ascending(delivered));
  EXPECT_TRUE(is_ascending(replay));
  EXPECT_LT(difference(steps(delivered), steps(replay)), 2.2);
  EXPECT_LT(difference(latencies(delivered), latencies(replay), kSchedulingDelay), 2.2);
}

// With jitter alone all samples arrive, and a third of them in order: a reader that gave out late
// ones would fail in each comparison.
TEST(ReplayAgreement, WithDdsInWhatArrivesInWhichOrderAndWhen) {
  std::vector<std::jthread> runs;  // side by side: a run waits most of the time
  for (const Setting& setting : settings()) {
    runs.emplace_back([&setting] {
      const testing::ScopedTrace trace(__FILE__, __LINE__, setting.name);
      expect_agreement(setting);
    });
  }
}

}  // namespace
}  // namespace fleetloc
