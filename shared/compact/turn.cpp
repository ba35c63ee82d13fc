#include "shared/compact/turn.hpp"

#include <cmath>

namespace fleetloc {

StrictRotation rotation_of(const Turn& turn, std::int32_t units) {
  StrictRotation q{};
  double rest = 1.0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == turn.largest) continue;
    q[i] = turn.others[next++] / static_cast<double>(units);
    rest = rest - q[i] * q[i];
  }
  q[turn.largest] = std::sqrt(rest);
  return q;
}

Turn turn_of(const StrictRotation& q, std::int32_t units) {
  Turn turn;
  for (std::uint32_t i = 1; i < 4; ++i) {
    if (std::abs(q[i]) > std::abs(q[turn.largest])) turn.largest = i;
  }
  const double sign = q[turn.largest] < 0.0 ? -1.0 : 1.0;
  std::size_t next = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == turn.largest) continue;
    turn.others[next++] = rounded(sign * q[i] * units, -units, units);
  }
  return turn;
}

}  // namespace fleetloc
