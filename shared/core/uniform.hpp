#pragma once

#include <cmath>
#include <random>

namespace fleetloc {

/// In [0, 1), the same with every standard library, unlike its distributions.
inline double uniform(std::mt19937_64& random) {
  return std::ldexp(static_cast<double>(random() >> 11U), -53);
}

}  // namespace fleetloc
