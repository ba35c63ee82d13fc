#pragma once

#include <cmath>
#include <random>

namespace fleetloc {

/// Uniform in [0, 1); the same with every standard library, unlike std::uniform_real_distribution.
inline double uniform(std::mt19937_64& random) {
  return std::ldexp(static_cast<double>(random() >> 11U), -53);
}

}  // namespace fleetloc
