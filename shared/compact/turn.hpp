#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "shared/coding/bit_model.hpp"
#include "shared/coding/integer_model.hpp"
#include "shared/coding/model_rows.hpp"
#include "shared/compact/strict_pose.hpp"

namespace fleetloc {

/// A rotation as integers: the three components of its quaternion other than the largest, which is
/// positive and follows from them.
struct Turn {
  std::uint32_t largest = 0;  ///< 0..3 of w, x, y, z
  std::array<std::int32_t, 3> others{};
};

/// Expects a valid turn: see code_turn().
/// @param units  for 1
StrictRotation rotation_of(const Turn& turn, std::int32_t units);
Turn turn_of(const StrictRotation& q, std::int32_t units);

struct TurnModels {
  BitModel is_far;  // w is not the largest component
  std::array<IntegerModel, 3> others;
};

template <typename Visit>
void for_each_row(const std::string& name, TurnModels& models, const Visit& visit) {
  for_each_row(name + ".is_far", models.is_far, visit);
  for_each_row(name + ".others", models.others, visit);
}

/// @return false if it is no rotation
template <typename Coder>
bool code_turn(Coder& coder, TurnModels& models, Turn& turn, std::int32_t units) {
  turn.largest = coder.code(models.is_far, turn.largest != 0) ? coder.code_raw(turn.largest, 2) : 0;
  std::int64_t squares = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    turn.others[i] = models.others[i].code_signed(coder, turn.others[i]);
    if (turn.others[i] > units || turn.others[i] < -units) return false;
    squares += std::int64_t{turn.others[i]} * turn.others[i];
  }
  return 100 * squares <= 76 * (std::int64_t{units} * units);  // 3/4 and rounding
}

}  // namespace fleetloc
