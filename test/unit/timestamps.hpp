#pragma once

#include "shared/core/time.hpp"

namespace fleetloc {

inline Timestamp at(double s) {
  return Timestamp{from_seconds(s)};
}

inline Timestamp at_ms(int ms) {
  return Timestamp{std::chrono::milliseconds(ms)};
}

inline double second_of(Timestamp stamp) {
  return to_seconds(stamp - Timestamp{});
}

}  // namespace fleetloc
