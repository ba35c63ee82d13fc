#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "deploy/evaluation/experiment/plan.hpp"

namespace fleetloc {

/// `count`, `seed`, `from_s`, `to_s`. Throws ConfigError.
StartsSpec read_starts(ConfigReader section);

/// Times in the dataset [s], each drawn alone.
std::vector<double> drawn_starts(const StartsSpec& starts);

/// Robots that somebody carries over a part of their way; each trial has a recording of its own.
struct CarriedSpec {
  int count = 0;
  std::uint64_t seed = 1;
  std::array<double, 2> start_s{};  ///< of the route: least and most, as the next two
  std::array<double, 2> after_s{};  ///< from the start on
  std::array<double, 2> for_s{};    ///< of the way
  double then_s = 0.0;              ///< driven afterwards
  bool reset = false;               ///< the IMU fails meanwhile, so that odometry begins anew
};

/// `count`, `seed`, `start_s`, `after_s`, `for_s`, `then_s` and `reset`. Throws ConfigError.
CarriedSpec read_carried(ConfigReader section);

/// `dataset`, which is simulated, `count` times, as `<name>_<number>` of the group `<name>`. Each
/// has a seed of its own, that of the dataset and those after it.
std::vector<DatasetSpec> carried_datasets(const DatasetSpec& dataset, const CarriedSpec& carried);

}  // namespace fleetloc
