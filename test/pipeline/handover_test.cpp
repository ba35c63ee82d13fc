// From one localizer to the next: what a robot notices of it, in simulated time.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "cloud/locate/pyramid_config.hpp"
#include "shared/core/percentile.hpp"
#include "test/pipeline/interruptible_system.hpp"

namespace fleetloc {
namespace {

struct Network {
  double loss;
  std::uint64_t seed;
};

LinkConfig link_of(const Network& network) {
  LinkConfig link = perfect_link();
  for (LinkDirection* direction : {&link.uplink, &link.downlink}) {
    direction->loss = network.loss;
    direction->delay_s = 0.05;
  }
  link.seed = network.seed;
  return link;
}

class Handover : public testing::TestWithParam<Network> {
 protected:
  static const SimulatedRun& run() {
    static const SimulatedRun run(noisy_flight());
    return run;
  }
  static std::shared_ptr<const LaserMap> map() {
    static const auto map = map_of(run());
    return map;
  }
  static Pose start() {
    Pose T = run().truth(run().frame_stamp(0)).T_odom_body;
    T.p += Eigen::Vector3d(0.2, -0.2, 0.1);
    return T;
  }
  static bool is_lossy() { return GetParam().loss > 0.0; }

  /// Arrivals of the applied answers.
  [[nodiscard]] std::vector<double> arrivals(double from_s, double to_s) const {
    std::vector<double> arrivals;
    for (const LocalizationOutput& answer : system_.robot().answers) {
      const double s = to_seconds(answer.arrival.time_since_epoch());
      if (answer.outcome && s > from_s && s <= to_s) arrivals.push_back(s);
    }
    return arrivals;
  }
  /// The longest time between them.
  [[nodiscard]] double longest_without(double from_s, double to_s) const {
    double longest_s = 0.0;
    double before_s = from_s;
    for (const double s : arrivals(from_s, to_s)) {
      longest_s = std::max(longest_s, s - before_s);
      before_s = s;
    }
    return std::max(longest_s, to_s - before_s);
  }
  [[nodiscard]] const std::string& localizer() const {
    return system_.robot().answers.back().answer.localizer;
  }
  void expect_good_poses(double from_s) const {
    std::vector<double> errors_m;
    for (const FrameOutput& frame : system_.robot().frames) {
      if (to_seconds(frame.stamp.time_since_epoch()) < from_s) continue;
      ASSERT_TRUE(frame.pose.T_map_body);
      const Pose& truth = run().truth(frame.stamp).T_odom_body;
      errors_m.push_back((frame.pose.T_map_body->p - truth.p).norm());
    }
    const double worst_m = *std::ranges::max_element(errors_m);
    std::printf("error: median %.3f m, worst %.3f m\n", percentile(errors_m, 0.5).value(), worst_m);
    EXPECT_LT(worst_m, 0.25);
    EXPECT_EQ(system_.robot().frames.back().pose.quality, Quality::kLocalized);
  }

  InterruptibleSystem system_{run(), start(), link_of(GetParam())};
};

TEST_P(Handover, ARollingRestartTakesNoAnswersAway) {
  system_.start("a", 1, map());
  system_.start("b", 1, map());
  system_.play(25.0);
  const double usual_s = longest_without(10.0, 25.0);
  double s = 25.0;
  for (const char* name : {"a", "b"}) {
    system_.stop(name);
    const double stopped_s = s;
    while (system_.runs(name)) system_.play(s += 0.1);
    std::printf("%s ended after %.1f s\n", name, s - stopped_s);
    // Of a robot whose farewell was lost it learns by silence, or not before `draining.max_s`.
    EXPECT_LT(s - stopped_s, is_lossy() ? 10.2 : 4.0) << "its robot has left";
    system_.start(name, 2, map());
    system_.play(s += 5.0);
  }
  system_.play(s += 5.0);
  const double longest_s = longest_without(25.0, s);
  std::printf("without an answer for %.2f s at most, usually %.2f s\n", longest_s, usual_s);
  EXPECT_LE(longest_s, is_lossy() ? usual_s + 2.5 : 1.5);
  expect_good_poses(10.0);
}

TEST_P(Handover, AKilledLocalizerIsMissedForSeconds) {
  system_.start("a", 1, map());
  system_.start("b", 1, map());
  system_.play(25.0);
  const std::string killed = localizer();
  system_.kill(killed);
  system_.play(40.0);
  const double missed_s = longest_without(25.0, 32.0);
  std::printf("without an answer for %.2f s\n", missed_s);
  EXPECT_LE(missed_s, is_lossy() ? 7.0 : 4.0);  // of forty robots nearly all need less than 5 s
  EXPECT_NE(localizer(), killed);
  expect_good_poses(10.0);
}

TEST_P(Handover, TheNextLocalizerContinuesWithAllKeyframes) {
  system_.start("a", 1, map());
  system_.play(30.0);
  system_.start("b", 1, map());
  system_.stop("a");
  system_.play(36.0);
  if (is_lossy()) system_.play(42.0);
  ASSERT_EQ(localizer(), "b");
  // Behind each answer is the window; its oldest keyframe tells how long it is.
  const auto window_s = [&](const LocalizationResult& answer) {
    return to_seconds(answer.stamp - answer.oldest_stamp);
  };
  double old_s = 0.0;
  double first_s = INFINITY;
  double longest_s = 0.0;
  for (const LocalizationOutput& output : system_.robot().answers) {
    if (output.answer.status != LocalizationStatus::kLocalized) continue;
    if (output.answer.localizer == "a") {
      old_s = window_s(output.answer);
    } else {
      if (first_s == INFINITY) first_s = window_s(output.answer);
      longest_s = std::max(longest_s, window_s(output.answer));
    }
  }
  std::printf("window of a %.1f s, of b %.1f s with its first answer, %.1f s at the end\n",
              old_s,
              first_s,
              longest_s);
  EXPECT_GT(longest_s, 0.8 * old_s);
}

TEST_P(Handover, StaysWithADrainingLocalizerWhileNobodyElseTakesRobots) {
  system_.start("a", 1, map());
  system_.play(25.0);
  system_.stop("a");
  system_.play(34.0);
  EXPECT_TRUE(system_.runs("a"));
  EXPECT_LE(longest_without(25.0, 34.0), is_lossy() ? 4.0 : 1.5);
  system_.play(37.0);
  EXPECT_FALSE(system_.runs("a")) << "its time is over";
  system_.start("a", 2, map());
  system_.play(45.0);
  EXPECT_LE(arrivals(37.0, 45.0).front(), 37.0 + (is_lossy() ? 5.0 : 2.0));
  expect_good_poses(10.0);
}

/// When a robot is localized first of which nobody tells where it is [s].
/// @param kill_at_s  when its localizer is killed; none: it is not
double found_at_s(const SimulatedRun& run,
                  const std::shared_ptr<const LaserMap>& map,
                  std::optional<double> kill_at_s) {
  const auto pyramid = make_pyramid(*map, read_localizer_pool_config(defaults()).pyramid);
  InterruptibleSystem system(run, std::nullopt, perfect_link());
  for (const char* name : {"a", "b"}) system.start(name, 1, map, "{}", pyramid);
  for (double s = 0.0; s < 30.0; s += 0.1) {
    system.play(s);
    if (!system.robot().frames.empty() &&
        system.robot().frames.back().pose.quality == Quality::kLocalized) {
      return s;
    }
    if (kill_at_s && s >= *kill_at_s && !system.robot().answers.empty()) {
      kill_at_s.reset();
      system.kill(system.robot().answers.back().answer.localizer);
    }
  }
  return 30.0;
}

// What it has seen goes with it, and the next localizer searches with all of that at once.
TEST(HandoverOfASearch, TakesNoLongerThanOfARobotThatHasAPlace) {
  const SimulatedRun run(noisy_flight());
  const auto map = map_of(run);
  const double undisturbed_s = found_at_s(run, map, std::nullopt);
  const double disturbed_s = found_at_s(run, map, undisturbed_s - 0.3);
  std::printf("found after %.1f s, %.1f s if it is killed before\n", undisturbed_s, disturbed_s);
  EXPECT_LT(undisturbed_s, 20.0);
  EXPECT_GT(disturbed_s, undisturbed_s) << "it was killed before";
  EXPECT_LE(disturbed_s, undisturbed_s + 2.5) << "less than a search from the beginning";
}

INSTANTIATE_TEST_SUITE_P(Loss,
                         Handover,
                         testing::Values(Network{0.0, 1},
                                         Network{0.0, 2},
                                         Network{0.0, 3},
                                         Network{0.5, 1},
                                         Network{0.5, 2},
                                         Network{0.5, 3}),
                         [](const auto& one) {
                           return "Of" + std::to_string(static_cast<int>(100.0 * one.param.loss)) +
                                  "PercentSeed" + std::to_string(one.param.seed);
                         });

}  // namespace
}  // namespace fleetloc
