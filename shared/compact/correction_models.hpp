#pragma once

#include <array>
#include <string>

#include "shared/coding/integer_model.hpp"
#include "shared/coding/model_rows.hpp"
#include "shared/compact/turn.hpp"

namespace fleetloc {

/// Models of roots of one size.
struct RootModels {
  IntegerModel scale;  // change from the one before
  IntegerModel diagonal, other;
};

/// What is likely in the corrections of an answer, as SubmapModels.
struct CorrectionModels {
  IntegerModel poses;
  IntegerModel newest_gap, gap, span;
  TurnModels turn;
  IntegerModel translation;
  std::array<RootModels, 2> pose_root;  // by scale: rotation, translation
  IntegerModel landmarks;
  IntegerModel landmark_gap;
  std::array<IntegerModel, 3> position;
  RootModels landmark_root;
};

template <typename Visit>
void for_each_row(const std::string& name, RootModels& models, const Visit& visit) {
  for_each_row(name + ".scale", models.scale, visit);
  for_each_row(name + ".diagonal", models.diagonal, visit);
  for_each_row(name + ".other", models.other, visit);
}

template <typename Visit>
void for_each_row(const std::string& name, CorrectionModels& models, const Visit& visit) {
  for_each_row(name + ".poses", models.poses, visit);
  for_each_row(name + ".newest_gap", models.newest_gap, visit);
  for_each_row(name + ".gap", models.gap, visit);
  for_each_row(name + ".span", models.span, visit);
  for_each_row(name + ".turn", models.turn, visit);
  for_each_row(name + ".translation", models.translation, visit);
  for_each_row(name + ".pose_root", models.pose_root, visit);
  for_each_row(name + ".landmarks", models.landmarks, visit);
  for_each_row(name + ".landmark_gap", models.landmark_gap, visit);
  for_each_row(name + ".position", models.position, visit);
  for_each_row(name + ".landmark_root", models.landmark_root, visit);
}

}  // namespace fleetloc
