#include "robot/uplink/submap_uplink.hpp"

#include <cstdio>
#include <map>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "shared/protocol/submap_receiver.hpp"
#include "test/unit/compact/moving_robot.hpp"

namespace fleetloc {
namespace {

using std::chrono::milliseconds;

SubmapUplink::Config some_config() {
  return {.encoding = SubmapEncoding::kCompact,
          .keyframes = 40,
          .window = 10,
          .min_missing = 0.1,
          .min_missing_alone = 0.3,
          .min_missing_edge = 0.01,
          .risky_loss = 0.05,
          .step_bits = 2,
          .thinned_step_bits = 1,
          .max_payload_bytes = 1200,
          .min_pause_s = 0.05,
          .handover_datagrams = 6,
          .handover_pause_s = 0.2,
          .budget = {.max_bytes_per_s = 3000.0,
                     .max_bytes_per_s_high_loss = 6000.0,
                     .high_loss = 0.75,
                     .min_bytes_per_s = 300.0,
                     .burst_bytes = 1600.0,
                     .max_queueing_s = 0.2,
                     .increase_bytes_per_s2 = 100.0,
                     .decrease = 0.7,
                     .shortest_memory_s = 120.0,
                     .unmeasured_bytes_per_s = 1200.0,
                     .measured_for_s = 10.0}};
}

/// A robot that drives on, its uplink, and a cloud that only stores and acknowledges; two keyframes
/// a second, and an answer 0.1 s after each sample.
class UplinkTest : public testing::Test {
 protected:
  UplinkTest() {
    for (auto& keyframe : drive_.keyframes) {
      if (keyframe.observations.size() > 40) keyframe.observations.resize(40);
    }
    for (std::size_t i = 0; i + 8 < drive_.edges.size(); ++i) drive_.edges[i].is_final = true;
    uplink_.start_session(some_stereo());
    uplink_.restart(SessionNumber{1}, Incarnation{1});
  }

  /// @param loss  of either direction
  void drive(int keyframes, double loss) {
    for (int i = 0; i < keyframes; ++i, ++next_) {
      const std::size_t begin = next_ > 10 ? next_ - 10 : 0;
      Submap window;
      for (std::size_t k = begin; k < next_; ++k) window.keyframes.push_back(drive_.keyframes[k]);
      for (std::size_t k = begin; k + 1 < next_; ++k) window.edges.push_back(drive_.edges[k]);
      uplink_.add(window);
      for (int ms = 0; ms < 500; ms += 5) run(loss);
    }
  }

  void run(double loss) {
    now_ += milliseconds(5);
    if (auto message = uplink_.next({}, now_)) arrive(*message, loss);
    if (answer_ && now_ >= answer_at_) {
      if (uniform_(random_) >= loss) uplink_.acknowledge(*answer_, now_);
      answer_.reset();
    }
  }

  void arrive(const Message& message, double loss) {
    ++samples_;
    bytes_ += message.payload.size() + 100;
    EXPECT_LE(message.payload.size(), 1200U);
    if (uniform_(random_) < loss) return;
    const SubmapSample sample = decode_submap_sample(message.payload).value();
    const Submap submap = decode_submap(sample, some_stereo()).value();
    if (!received_.is_new(sample.number)) return;
    received_.store(sample.number, now_);
    for (const auto& keyframe : submap.keyframes) {
      for (const auto& one : keyframe.observations) stored_[keyframe.id].insert(one.landmark);
    }
    LocalizationResult answer;
    answer.session = SessionNumber{1};
    answer.incarnation = Incarnation{1};
    answer.keyframe = sample.keyframe;
    answer.acknowledgements = received_.acknowledgements();
    answer_ = answer;
    answer_at_ = now_ + milliseconds(100);
  }

  void another_localizer_begins() {
    stored_.clear();
    received_ = {};
    uplink_.restart(SessionNumber{1}, Incarnation{1});
  }

  /// Share of the observations of the latest 40 keyframes but two that the cloud has.
  [[nodiscard]] double stored_share() const {
    double stored = 0.0;
    double all = 0.0;
    for (std::size_t k = next_ > 40 ? next_ - 40 : 0; k + 3 < next_; ++k) {
      const auto found = stored_.find(drive_.keyframes[k].id);
      stored += found == stored_.end() ? 0.0 : static_cast<double>(found->second.size());
      all += static_cast<double>(drive_.keyframes[k].observations.size());
    }
    return stored / all;
  }

  Submap drive_ = moving_robot(100, 220);
  SubmapUplink uplink_{"robot_1", some_config()};
  std::size_t next_ = 1;
  Timestamp now_{};
  std::mt19937 random_{5};
  std::uniform_real_distribution<double> uniform_;
  SubmapReceiver received_;
  std::map<KeyframeId, std::set<LandmarkId>> stored_;
  std::optional<LocalizationResult> answer_;
  Timestamp answer_at_;
  int samples_ = 0;
  std::size_t bytes_ = 0;
};

TEST_F(UplinkTest, WithoutLossEachKeyframeTakesOneSample) {
  drive(10, 0.0);
  EXPECT_LE(samples_, 14) << "nothing is known of the link at first";
  samples_ = 0;
  bytes_ = 0;
  drive(60, 0.0);
  EXPECT_NEAR(samples_, 60, 1);
  EXPECT_EQ(stored_share(), 1.0);
  EXPECT_LT(static_cast<double>(bytes_) / 30.0, 1600.0);
}

TEST_F(UplinkTest, WhatIsLostIsSentAgainWithinTheBudget) {
  for (const auto& [loss, share] :
       std::map<double, double>{{0.5, 0.95}, {0.7, 0.75}, {0.8, 0.65}}) {
    const std::size_t bytes_before = bytes_;
    drive(60, loss);
    EXPECT_GT(stored_share(), share) << "loss " << loss;
    std::printf("loss %.1f: %.3f of the observations arrived\n", loss, stored_share());
    EXPECT_LT(static_cast<double>(bytes_ - bytes_before) / 30.0, loss < 0.75 ? 3100.0 : 6200.0);
  }
}

TEST_F(UplinkTest, AfterAnOutageTheLatestFortyKeyframesArrive) {
  drive(20, 0.0);
  drive(60, 1.0);
  EXPECT_LT(stored_share(), 0.1);
  drive(3, 0.0);
  EXPECT_GT(stored_share(), 0.95) << "1.5 s after its end";
}

TEST_F(UplinkTest, AnotherLocalizerGetsAllKeyframesWithinSeconds) {
  drive(50, 0.0);
  another_localizer_begins();
  drive(5, 0.0);
  EXPECT_GT(stored_share(), 0.95);
}

TEST_F(UplinkTest, AnotherLocalizerGetsSomethingOfEachKeyframeWithinASecond) {
  drive(50, 0.0);
  another_localizer_begins();
  drive(2, 0.0);
  EXPECT_GE(stored_.size(), 37U) << "of 40: none waits for the rest of another one";
}

TEST_F(UplinkTest, ALocalizerThatHasLostTheSessionGetsAllKeyframesAgain) {
  drive(50, 0.0);
  stored_.clear();
  received_ = {};
  uplink_.forget_deliveries();
  drive(8, 0.0);
  EXPECT_GT(stored_share(), 0.95);
}

TEST_F(UplinkTest, ANewSessionSendsNothingOfTheOneBefore) {
  drive(20, 0.0);
  uplink_.start_session(some_stereo());
  const int before = samples_;
  for (int i = 0; i < 400; ++i) run(0.0);
  EXPECT_EQ(samples_, before);
}

TEST_F(UplinkTest, KeyframesBeyondTheWireAreRefusedOnce) {
  drive_.keyframes[0].observations[0].left.x() = 1e9;
  Submap window;
  window.keyframes = {drive_.keyframes[0]};
  uplink_.add(window);
  EXPECT_THROW(static_cast<void>(uplink_.next({}, now_)), NotEncodable);
  EXPECT_NO_THROW(static_cast<void>(uplink_.next({}, now_)));
}

}  // namespace
}  // namespace fleetloc
