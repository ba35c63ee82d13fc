#include "deploy/evaluation/experiment/draw_trials.hpp"

#include <limits>
#include <string>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "shared/core/counter_random.hpp"
#include "shared/core/exact_text.hpp"

namespace fleetloc {
namespace {

constexpr int kMostTrials = 10'000;
constexpr double kLongestDrive_s = 1e6;

// Streams of random numbers of their own.
constexpr std::uint64_t kStartStream = 0x737461727473;
constexpr std::uint64_t kCarriedStream = 0x63617272696564;

std::uint64_t read_trial_seed(ConfigReader& section) {
  return static_cast<std::uint64_t>(section.integer("seed", 0, std::numeric_limits<int>::max()));
}

std::array<double, 2> read_range(ConfigReader& section, const std::string& key) {
  const auto range = section.get<std::vector<double>>(key);
  if (range.size() != 2 ||
      !(range[0] >= 0.0 && range[0] <= range[1] && range[1] <= kLongestDrive_s)) {
    section.fail(key, "must be [least, most] in seconds, from 0 to 1e6");
  }
  return {range[0], range[1]};
}

double between(const std::array<double, 2>& range, double share) {
  return range[0] + share * (range[1] - range[0]);
}

/// The configuration with `sim.carried` in it.
std::string with_carried(const std::string& config, double at_s, double for_s) {
  YAML::Node yaml = YAML::Load(config.empty() ? "{}" : config);
  YAML::Node carried = yaml["sim"]["carried"];
  carried["at_s"] = exact_text(at_s);
  carried["for_s"] = exact_text(for_s);
  return YAML::Dump(yaml) + "\n";
}

}  // namespace

StartsSpec read_starts(ConfigReader section) {
  StartsSpec starts{.count = section.integer("count", 1, kMostTrials),
                    .seed = read_trial_seed(section),
                    .from_s = section.number("from_s", 0.0, kLongestDrive_s)};
  starts.to_s = section.number("to_s", starts.from_s, kLongestDrive_s);
  return starts;
}

std::vector<double> drawn_starts(const StartsSpec& starts) {
  const CounterRandom random(starts.seed, kStartStream);
  std::vector<double> times_s;
  for (int i = 0; i < starts.count; ++i) {
    times_s.push_back(
        between({starts.from_s, starts.to_s}, random.uniform(static_cast<std::uint64_t>(i))));
  }
  return times_s;
}

CarriedSpec read_carried(ConfigReader section) {
  return {.count = section.integer("count", 1, kMostTrials),
          .seed = read_trial_seed(section),
          .start_s = read_range(section, "start_s"),
          .after_s = read_range(section, "after_s"),
          .for_s = read_range(section, "for_s"),
          .then_s = section.positive("then_s"),
          .reset = section.get<bool>("reset")};
}

std::vector<DatasetSpec> carried_datasets(const DatasetSpec& dataset, const CarriedSpec& carried) {
  const CounterRandom random(carried.seed, kCarriedStream);
  std::vector<DatasetSpec> trials;
  for (int i = 0; i < carried.count; ++i) {
    const auto draw = [&](std::uint64_t item) {
      return random.uniform(static_cast<std::uint64_t>(i), item);
    };
    const double start_s = between(carried.start_s, draw(0));
    const double after_s = between(carried.after_s, draw(1));
    DatasetSpec trial = dataset;
    trial.name = dataset.name + "_" + std::to_string(i + 1);
    auto simulated = std::get<SimulatedDataset>(dataset.source);
    simulated.seed += static_cast<std::uint64_t>(i);
    simulated.start_s = start_s;
    simulated.duration_s = after_s + carried.then_s;
    simulated.config =
        with_carried(simulated.config, start_s + after_s, between(carried.for_s, draw(2)));
    trial.source = std::move(simulated);
    if (carried.reset) {
      trial.faults = "seed: 1\nfaults: [{kind: imu_gap, start_s: " + exact_text(after_s) +
                     ", duration_s: 1}]\n";
    }
    trials.push_back(std::move(trial));
  }
  return trials;
}

}  // namespace fleetloc
