#pragma once

#include <cstdint>

#include "shared/core/counter_random.hpp"

namespace fleetloc {

/// Streams of random numbers, one for each kind of object, so that more trees move no building.
enum class RandomStream : std::uint8_t {
  kGround,
  kBuilding,
  kTree,
  kFurniture,
  kCar,
  kStructure,
  kSeason,
  kDynamicObject,
  kRow,
};

/// The random numbers of one object of the world, one after the other.
class Draw {
 public:
  Draw(std::uint64_t seed, RandomStream stream, std::uint64_t index)
      : random_(seed, static_cast<std::uint64_t>(stream)), index_(index) {}

  /// In (min, max).
  float uniform(float min, float max) {
    return min + (max - min) * static_cast<float>(random_.uniform(index_, item_++));
  }
  bool chance(float share) { return uniform(0.0F, 1.0F) < share; }
  /// In [0, count).
  int integer(int count) {
    const int drawn = static_cast<int>(uniform(0.0F, static_cast<float>(count)));
    return drawn < count ? drawn : count - 1;
  }
  std::uint32_t bits() {
    return static_cast<std::uint32_t>(random_.uniform(index_, item_++) * 4294967296.0);
  }

 private:
  CounterRandom random_;
  std::uint64_t index_;
  std::uint64_t item_ = 0;
};

}  // namespace fleetloc
