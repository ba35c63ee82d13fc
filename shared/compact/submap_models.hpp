#pragma once

#include <array>
#include <cstddef>

#include "shared/coding/bit_model.hpp"
#include "shared/coding/integer_model.hpp"
#include "shared/compact/turn.hpp"

namespace fleetloc {

/// What is likely in a submap, before its first bit: learnt from recordings, and part of the
/// encoding's version. Every sample begins with it.
struct SubmapModels {
  /// How an observation follows from the one before: once seen, twice, more often.
  static constexpr std::size_t kSeen = 3;
  /// Keyframes in a row in which a landmark was missed, before it is given up.
  static constexpr std::size_t kMisses = 3;
  /// An edge from the keyframe before; any other one.
  static constexpr std::size_t kEdgeKinds = 2;

  IntegerModel keyframes;
  IntegerModel id_gap;
  IntegerModel interval;  // first of a sample
  IntegerModel interval_change;
  std::array<IntegerModel, 2> displacement;  // first of a sample: horizontal, vertical
  std::array<IntegerModel, 2> displacement_change;
  TurnModels turn;
  BitModel has_observations;
  IntegerModel tilt;  // first of a sample
  IntegerModel tilt_change;

  std::array<std::array<BitModel, kMisses>, kSeen> observed;
  std::array<IntegerModel, kSeen> u, v, disparity;
  std::array<BitModel, 2> in_right;  // of a landmark that was not, that was
  IntegerModel new_landmarks;
  IntegerModel first_landmark;  // of a keyframe
  IntegerModel landmark_gap;
  IntegerModel new_u, new_v, new_disparity;

  BitModel follows;  // an edge from the keyframe before
  IntegerModel other_edges;
  IntegerModel edge_to, edge_from;
  std::array<std::array<IntegerModel, 3>, kEdgeKinds> sigma;
  std::array<std::array<IntegerModel, 2>, kEdgeKinds> deviation;  // rotation, translation
};

}  // namespace fleetloc
