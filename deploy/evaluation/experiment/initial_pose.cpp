#include "deploy/evaluation/experiment/initial_pose.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "shared/config/delimited_file.hpp"
#include "shared/core/counter_random.hpp"

namespace fleetloc {

std::array<double, 4> start_displacement(const StartError& error, std::uint64_t seed) {
  constexpr std::uint64_t kStream = 0x7374617274;  // of its own
  const CounterRandom random(seed, kStream);
  const double direction = 2.0 * std::numbers::pi * random.uniform(0);
  const double up = (random.uniform(1) < 0.5 ? -1.0 : 1.0) * error.position_m / 3.0;
  const double across = error.position_m * std::sqrt(8.0) / 3.0;
  const double yaw_deg = random.uniform(2) < 0.5 ? -error.yaw_deg : error.yaw_deg;
  return {across * std::cos(direction), across * std::sin(direction), up, yaw_deg};
}

Timestamp first_frame(const std::filesystem::path& index, double start_s) {
  DelimitedFile file(index, ',');
  std::optional<Timestamp> begin;
  while (file.next()) {
    const Timestamp stamp = file.nanoseconds(0);
    if (!begin) begin = stamp + from_seconds(start_s);
    if (stamp >= *begin) return stamp;
  }
  throw TextFileError(index.string() + ": ends before the start");
}

}  // namespace fleetloc
