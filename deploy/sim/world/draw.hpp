#pragma once

#include <cstdint>

#include "shared/core/counter_random.hpp"

namespace fleetloc {

/// What the world draws lots for. Each has numbers of its own, so that more trees move no building.
enum class Lot : std::uint8_t {
  kGround,
  kBuilding,
  kTree,
  kFurniture,
  kCar,
  kStructure,
  kSession,
  kDynamicObject,
};

/// Random numbers in a row, for one object of the world.
class Draw {
 public:
  Draw(std::uint64_t seed, Lot lot, std::uint64_t index)
      : random_(seed, static_cast<std::uint64_t>(lot)), index_(index) {}

  /// In (least, most).
  float uniform(float least, float most) {
    return least + (most - least) * static_cast<float>(random_.uniform(index_, item_++));
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
