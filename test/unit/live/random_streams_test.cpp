// Streams of two cameras and an IMU with jitter, loss, copies and other orders, with fixed seeds.
#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "test/unit/live/live_sensors.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

constexpr Duration kImuInterval = 5ms;
constexpr Duration kFrameInterval = 50ms;
constexpr int kFrames = 200;
constexpr int kSamplesAFrame = kFrameInterval / kImuInterval;

struct Disturbance {
  Duration skew{};    // of the right stamp, up to it
  Duration jitter{};  // of arrivals, up to it
  double lost = 0.0;
  double doubled = 0.0;
};

enum class Kind { kLeft, kRight, kImu };

struct Message {
  Kind kind;
  std::uint32_t number;  // of the frame
  Duration stamp;
  Duration arrival;
};

class Streams {
 public:
  Streams(unsigned seed, const Disturbance& disturbance)
      : random_(seed), disturbance_(disturbance) {
    for (int i = 0; i < kFrames * kSamplesAFrame; ++i) add(Kind::kImu, 0, 1s + i * kImuInterval);
    for (int i = 0; i < kFrames - 1; ++i) {
      const Duration stamp = 1s + i * kFrameInterval;
      const auto number = static_cast<std::uint32_t>(i + 1);
      add(Kind::kLeft, number, stamp);
      add(Kind::kRight, number, stamp + up_to(2 * disturbance.skew) - disturbance.skew);
    }
    std::ranges::stable_sort(messages_, {}, &Message::arrival);
  }

  [[nodiscard]] const std::vector<Message>& messages() const { return messages_; }

 private:
  Duration up_to(Duration most) {
    return Duration(std::uniform_int_distribution<std::int64_t>(0, most.count())(random_));
  }
  bool happens(double share) { return std::bernoulli_distribution(share)(random_); }

  void add(Kind kind, std::uint32_t number, Duration stamp) {
    constexpr Duration kTransfer = 10ms;
    if (happens(disturbance_.lost)) return;
    messages_.push_back({kind, number, stamp, stamp + kTransfer + up_to(disturbance_.jitter)});
    if (happens(disturbance_.doubled)) {
      messages_.push_back({kind, number, stamp, stamp + kTransfer + up_to(disturbance_.jitter)});
    }
  }

  std::mt19937 random_;
  Disturbance disturbance_;
  std::vector<Message> messages_;
};

/// Takes what comes out, and checks what must always hold.
class Taker {
 public:
  void take_from(SensorAssembler& assembler) {
    EXPECT_LE(assembler.held(), 100U);
    while (const auto measurement = assembler.take()) {
      if (const auto* sample = std::get_if<ImuSample>(&*measurement)) {
        EXPECT_GT(sample->stamp, imu_);
        imu_ = sample->stamp;
      } else {
        take(std::get<StereoFrame>(std::get<CameraFrame>(*measurement)));
      }
    }
  }

  [[nodiscard]] std::size_t pairs() const { return pairs_; }
  [[nodiscard]] std::size_t frames() const { return frames_; }

 private:
  void take(const StereoFrame& frame) {
    EXPECT_GT(frame.stamp, frame_);
    EXPECT_LE(frame.stamp - imu_, 500ms);
    frame_ = frame.stamp;
    ++frames_;
    ASSERT_FALSE(frame.left.empty() && frame.right.empty());
    if (!frame.left.empty()) {
      EXPECT_TRUE(left_.insert(number_of(frame.left)).second);
    }
    if (!frame.right.empty()) {
      EXPECT_TRUE(right_.insert(number_of(frame.right)).second);
    }
    if (frame.left.empty() || frame.right.empty()) return;
    EXPECT_EQ(number_of(frame.left), number_of(frame.right));
    ++pairs_;
  }

  Timestamp imu_;
  Timestamp frame_;
  std::set<std::uint32_t> left_;
  std::set<std::uint32_t> right_;
  std::size_t frames_ = 0;
  std::size_t pairs_ = 0;
};

Taker play(const Streams& streams) {
  SensorAssembler assembler({}, {"/left", "/right", "/imu"}, small_cameras());
  Taker taker;
  for (const Message& message : streams.messages()) {
    const ArrivalTime arrival = arriving(message.arrival);
    if (message.kind == Kind::kImu) {
      assembler.add_imu(sample(message.stamp), arrival);
    } else if (message.kind == Kind::kLeft) {
      assembler.add_left(at(message.stamp), image(message.number), arrival);
    } else {
      assembler.add_right(at(message.stamp), image(message.number), arrival);
    }
    taker.take_from(assembler);
  }
  assembler.poll(arriving(1min));
  taker.take_from(assembler);
  return taker;
}

TEST(RandomStreams, LoseNothingWhereNothingIsDisturbed) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Taker taker = play(Streams(seed, {.skew = 4ms, .jitter = 4ms}));
    EXPECT_EQ(taker.pairs(), static_cast<std::size_t>(kFrames - 1)) << seed;
    EXPECT_EQ(taker.frames(), taker.pairs()) << seed;
  }
}

TEST(RandomStreams, LoseOnlyThePairsOfLostImages) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Streams streams(seed, {.skew = 4ms, .jitter = 4ms, .lost = 0.1});
    const Taker taker = play(streams);
    std::map<std::uint32_t, int> images;
    for (const Message& message : streams.messages()) {
      if (message.kind != Kind::kImu) ++images[message.number];
    }
    const auto complete =
        std::ranges::count_if(images, [](const auto& it) { return it.second == 2; });
    EXPECT_EQ(taker.pairs(), static_cast<std::size_t>(complete)) << seed;
    EXPECT_EQ(taker.frames(), images.size()) << seed;
  }
}

TEST(RandomStreams, GiveNothingTwiceAndEverythingInOrderWhateverHappens) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const auto up_to = [&](double most) {
      return std::uniform_real_distribution<double>(0.0, most)(random);
    };
    const Disturbance disturbance{.skew = from_seconds(up_to(0.004)),
                                  .jitter = from_seconds(up_to(0.3)),
                                  .lost = up_to(0.5),
                                  .doubled = up_to(0.5)};
    EXPECT_GT(play(Streams(seed, disturbance)).frames(), 0U) << seed;
  }
}

// Stamps and times that make no sense at all: bounded, and no crash.
TEST(RandomStreams, MayBeNoise) {
  SensorAssembler assembler({}, {"/left", "/right", "/imu"}, small_cameras());
  std::mt19937_64 random(1);
  Duration arrival{};
  for (int i = 0; i < 100'000; ++i) {
    const Timestamp stamp{Duration(static_cast<std::int64_t>(random() >> 2U) >> (random() % 40))};
    arrival += Duration(static_cast<std::int64_t>(random() % 100'000'000));
    switch (random() % 3) {
      case 0:
        assembler.add_left(stamp, image(), arriving(arrival));
        break;
      case 1:
        assembler.add_right(stamp, image(), arriving(arrival));
        break;
      default:
        assembler.add_imu({.stamp = stamp}, arriving(arrival));
    }
    ASSERT_LE(assembler.held(), 4100U);
  }
  EXPECT_LE(assembler.take_events().size(), 64U);
}

}  // namespace
}  // namespace fleetloc
