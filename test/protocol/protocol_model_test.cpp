// Both ends of the protocol against each other, under everything that networks, operators and
// clocks do to them, and a simple model alongside that says what must hold after each step.
// PROTOCOL_MODEL_SEEDS=100 runs more seeds, with PROTOCOL_MODEL_STEPS=1000000 longer ones.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <malloc.h>

#include "cloud/laser_map/build_map.hpp"
#include "test/protocol/model_localizer.hpp"
#include "test/protocol/model_robot.hpp"
#include "test/protocol/violation.hpp"
#include "test/simulated_setup.hpp"

namespace fleetloc {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr std::uint64_t kSteps = 10'000;
#else
constexpr std::uint64_t kSteps = 100'000;
#endif
constexpr Duration kStep = std::chrono::milliseconds(40);
constexpr double kGoodSeconds = 120.0;    // of a good link; towards its end everything has arrived
constexpr double kCheckedSeconds = 40.0;  // of those, the last
constexpr double kSettledSeconds = 10.0;  // after a robot has stood still, and was forgotten
constexpr std::size_t kMaxClientBytes = 2'000'000;
constexpr std::size_t kMaxLocalizerBytes = 20'000'000;

std::uint64_t setting(const char* name, std::uint64_t otherwise) {
  const char* value = std::getenv(name);
  return value != nullptr ? std::strtoull(value, nullptr, 10) : otherwise;
}

std::size_t heap_bytes() {
  return mallinfo2().uordblks;
}

std::shared_ptr<const LaserMap> some_map() {
  static const auto map =
      std::make_shared<const LaserMap>(build_map({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                                 "map",
                                                 read_map_config(defaults().section("map"))));
  return map;
}

/// Two robots, three localizers, a network, and a driver that disturbs them at random. Times of
/// disturbances and times of peace take turns.
class DisturbedFleet {
 public:
  explicit DisturbedFleet(std::uint32_t seed) : random_(seed), network_(seed + 1) {
    CloudClient::Config config = read_cloud_client_config(defaults().section("client"));
    config.stream.uplink.max_payload_bytes = 420;  // keyframes here have few observations
    for (const char* name : {"robot_1", "robot_2"}) {
      robots_.push_back(std::make_unique<ModelRobot>(name, network_, record_, config, random_()));
    }
    for (const char* name : {"alpha", "beta", "gamma"}) start(name);
    begin_peace(false);
  }

  void step() {
    now_ += kStep;
    if (now_ >= phase_ends_) {
      if (is_peace_) ++recoveries_;
      begin_peace(!is_peace_);
    }
    if (is_peace_ && to_seconds(phase_ends_ - now_) < kCheckedSeconds) check_recovered();
    if (!is_peace_) disturb();
    network_.advance(now_);
    for (auto& [name, localizer] : localizers_) {
      if (localizer) localizer->step(now_);
    }
    for (auto& robot : robots_) robot->step(now_);
  }

  [[nodiscard]] int recoveries() const { return recoveries_; }
  [[nodiscard]] double seconds() const { return to_seconds(now_.time_since_epoch()); }

 private:
  bool happens(double every_s) { return uniform() < to_seconds(kStep) / every_s; }
  double uniform() { return std::uniform_real_distribution<double>()(random_); }
  ModelRobot& any_robot() { return *robots_[random_() % robots_.size()]; }

  void start(const std::string& name) {
    LocalizerPool::Config config = read_localizer_pool_config(defaults());
    config.protocol.idle_session_s = 8.0;  // robots stand still for longer, and are forgotten
    localizers_[name] = std::make_unique<ModelLocalizer>(
        name, Incarnation{++incarnations_}, some_map(), config, network_, record_, random_());
  }

  void kill(const std::string& name) {
    if (!localizers_.at(name)) return;
    const std::size_t before = heap_bytes();
    localizers_.at(name).reset();
    const std::size_t held = before - std::min(before, heap_bytes());
    expect(held < kMaxLocalizerBytes, name + " held " + std::to_string(held) + " bytes");
    starts_at_[name] = now_ + from_seconds(20.0 * uniform());
  }

  void restart(ModelRobot& robot) {
    robot.restart();
    expect(robot.freed_bytes() < kMaxClientBytes,
           robot.id() + " held " + std::to_string(robot.freed_bytes()) + " bytes");
  }

  void begin_peace(bool is_peace) {
    is_peace_ = is_peace;
    phase_ends_ = now_ + from_seconds(is_peace ? kGoodSeconds : 40.0 + 120.0 * uniform());
    network_.disturb({});
    for (auto& robot : robots_) robot->forges_first_samples = !is_peace;
    if (!is_peace) return;
    for (auto& [name, localizer] : localizers_) {
      if (!localizer) start(name);
      localizer->set_job_time(0.04);
      localizer->pause_until(now_);
    }
    starts_at_.clear();
  }

  void disturb() {
    if (happens(10.0)) {
      const bool is_outage = uniform() < 0.1;
      network_.disturb({.loss = is_outage ? 1.0 : std::max(0.0, 1.3 * uniform() - 0.4),
                        .duplication = uniform() < 0.5 ? 0.0 : 0.5 * uniform(),
                        .delay_s = uniform() < 0.7 ? 0.1 * uniform() : 6.0 * uniform(),
                        .jitter_s = uniform() < 0.5 ? 0.0 : 1.0 * uniform(),
                        .drops_late = uniform() < 0.5});
    }
    disturb_robots();
    disturb_localizers();
    forge();
  }

  void disturb_robots() {
    if (happens(60.0)) restart(any_robot());
    if (happens(40.0)) any_robot().reset_odometry();
    if (!happens(40.0)) return;
    ModelRobot& robot = any_robot();
    const bool is_back = uniform() < 0.5;
    const double by_s = std::pow(10.0, 3.5 * uniform());
    robot.step_clock(from_seconds(is_back ? -by_s : by_s));
    if (is_back || uniform() < 0.5) robot.reset_odometry();
  }

  void disturb_localizers() {
    for (auto& [name, localizer] : localizers_) {
      if (happens(60.0)) kill(name);
      if (localizer && happens(60.0)) localizer->pause_until(now_ + from_seconds(20.0 * uniform()));
      if (localizer && happens(30.0)) localizer->set_job_time(uniform() < 0.5 ? 0.04 : uniform());
      const auto starts = starts_at_.find(name);
      if (!localizer && starts != starts_at_.end() && now_ >= starts->second) start(name);
    }
  }

  // Two of one kind near each other are believed; one is not.
  void forge() {
    if (!happens(20.0)) return;
    ModelRobot& robot = any_robot();
    const auto ahead = static_cast<std::uint32_t>(random_() % 2'000'000'000 + 5000);
    if (uniform() < 0.5) {
      if (auto forged = robot.forged_sample(ahead)) {
        network_.inject(false, forged->first, std::move(forged->second));
      }
    } else if (auto forged = robot.forged_answer(ahead)) {
      network_.inject(true, robot.id(), *std::move(forged));
    }
  }

  void check_recovered() const {
    for (const auto& robot : robots_) {
      if (robot->moving_for_s() > kSettledSeconds) check_recovered(*robot);
    }
  }

  void check_recovered(const ModelRobot& robot) const {
    const std::string& localizer = robot.statistics().localizer;
    const std::string who = robot.id() + " at " + localizer + ": ";
    expect(!localizer.empty(), who + "there is no localizer");
    expect(robot.unanswered() < 8, who + "no answers for the latest keyframes");
    expect(robot.statistics().loss < 0.2, who + "still believes that the link is bad");
    const SessionDatabase* database = localizers_.at(localizer)->database(robot.session());
    expect(database != nullptr, who + "no database");
    const auto& keyframes = robot.keyframes();
    for (std::size_t age = 3; age < std::min<std::size_t>(38, keyframes.size()); ++age) {
      const SubmapKeyframe& sent = keyframes[keyframes.size() - 1 - age];
      const auto stored = database->keyframes().find(sent.id);
      const std::string which = "keyframe " + std::to_string(static_cast<std::uint32_t>(sent.id));
      expect(stored != database->keyframes().end(), who + which + " has never arrived");
      expect(10 * stored->second.item.observations.size() >= 7 * sent.observations.size(),
             who + which + " lacks observations");
    }
    expect(database->window().size() + 3 >= database->keyframes().size(),
           who + "the window is not connected");
  }

  std::mt19937 random_;
  DisturbedNetwork network_;
  SentRecord record_;
  std::vector<std::unique_ptr<ModelRobot>> robots_;
  std::map<std::string, std::unique_ptr<ModelLocalizer>> localizers_;
  std::map<std::string, Timestamp> starts_at_;
  std::uint32_t incarnations_ = 0;
  Timestamp now_{std::chrono::hours(24)};
  Timestamp phase_ends_{};
  bool is_peace_ = false;
  int recoveries_ = 0;
};

/// Throws Violation, or says how often the fleet recovered.
void expect_to_hold(std::uint64_t seed, std::uint64_t steps) {
  DisturbedFleet fleet(static_cast<std::uint32_t>(seed));
  std::uint64_t step = 0;
  try {
    for (; step < steps; ++step) fleet.step();
    std::printf("seed %lu: %d recoveries\n", seed, fleet.recoveries());
  } catch (const Violation& violation) {
    ADD_FAILURE() << "seed " << seed << ", step " << step << ": " << violation.what();
  }
}

class ProtocolModel : public testing::TestWithParam<std::uint64_t> {};

TEST_P(ProtocolModel, HoldsUnderLossReorderingRestartsHandoversAndClockSteps) {
  expect_to_hold(GetParam(), kSteps);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ProtocolModel, testing::Values(1, 2));

TEST(ProtocolModelAtLength, HoldsWithMoreSeeds) {
  const std::uint64_t seeds = setting("PROTOCOL_MODEL_SEEDS", 0);
  if (seeds == 0) GTEST_SKIP() << "PROTOCOL_MODEL_SEEDS says how many";
  const std::uint64_t first = setting("PROTOCOL_MODEL_FIRST_SEED", 1);
  for (std::uint64_t seed = first; seed < first + seeds; ++seed) {
    expect_to_hold(seed, setting("PROTOCOL_MODEL_STEPS", kSteps));
  }
}

}  // namespace
}  // namespace fleetloc
