#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "shared/coding/bit_model.hpp"
#include "shared/coding/integer_model.hpp"
#include "shared/compact/turn.hpp"

namespace fleetloc {

/// What is likely in a submap. Every sample begins with trained_models(), before its first bit.
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

template <typename Visit>
void for_each_row(const std::string& name, SubmapModels& models, const Visit& visit) {
  for_each_row(name + ".keyframes", models.keyframes, visit);
  for_each_row(name + ".id_gap", models.id_gap, visit);
  for_each_row(name + ".interval", models.interval, visit);
  for_each_row(name + ".interval_change", models.interval_change, visit);
  for_each_row(name + ".displacement", models.displacement, visit);
  for_each_row(name + ".displacement_change", models.displacement_change, visit);
  for_each_row(name + ".turn", models.turn, visit);
  for_each_row(name + ".has_observations", models.has_observations, visit);
  for_each_row(name + ".tilt", models.tilt, visit);
  for_each_row(name + ".tilt_change", models.tilt_change, visit);
  for_each_row(name + ".observed", models.observed, visit);
  for_each_row(name + ".u", models.u, visit);
  for_each_row(name + ".v", models.v, visit);
  for_each_row(name + ".disparity", models.disparity, visit);
  for_each_row(name + ".in_right", models.in_right, visit);
  for_each_row(name + ".new_landmarks", models.new_landmarks, visit);
  for_each_row(name + ".first_landmark", models.first_landmark, visit);
  for_each_row(name + ".landmark_gap", models.landmark_gap, visit);
  for_each_row(name + ".new_u", models.new_u, visit);
  for_each_row(name + ".new_v", models.new_v, visit);
  for_each_row(name + ".new_disparity", models.new_disparity, visit);
  for_each_row(name + ".follows", models.follows, visit);
  for_each_row(name + ".other_edges", models.other_edges, visit);
  for_each_row(name + ".edge_to", models.edge_to, visit);
  for_each_row(name + ".edge_from", models.edge_from, visit);
  for_each_row(name + ".sigma", models.sigma, visit);
  for_each_row(name + ".deviation", models.deviation, visit);
}

}  // namespace fleetloc
