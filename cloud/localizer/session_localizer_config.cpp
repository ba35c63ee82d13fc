#include "cloud/localizer/session_localizer.hpp"

namespace fleetloc {
namespace {

SessionLocalizer::Convergence read_convergence(ConfigReader section) {
  return {.max_rounds = section.integer("max_rounds", 1, 100),
          .iterations = section.integer("iterations", 1, 100),
          .min_decrease = section.positive("min_decrease"),
          .settled_m = section.positive("settled_m")};
}

SessionLocalizer::Rounds read_rounds(ConfigReader section) {
  return {.final_gate_m = section.positive("final_gate_m"),
          .tracking_gate_m = section.positive("tracking_gate_m"),
          .widest_gate_m = section.positive("widest_gate_m"),
          .gate_sigmas = section.positive("gate_sigmas"),
          .shrink = section.positive("shrink"),
          .early_look_way_m = section.positive("early_look_way_m"),
          .tracking = read_convergence(section.section("tracking")),
          .rough = read_convergence(section.section("rough"))};
}

SessionLocalizer::CovarianceInflation read_covariance_inflation(ConfigReader section) {
  return {.floor_m = section.positive("floor_m"),
          .floor_rad = section.positive("floor_rad"),
          .prior_floor_m = section.positive("prior_floor_m"),
          .prior_floor_rad = section.positive("prior_floor_rad"),
          .start_floor_m = section.positive("start_floor_m"),
          .start_floor_rad = section.positive("start_floor_rad")};
}

}  // namespace

SessionLocalizer::Config read_session_localizer_config(ConfigReader section) {
  return {
      .database = {.window = section.integer("window", 2, 1000)},
      .problem = read_window_problem_config(section.section("problem")),
      .association = read_association_config(section.section("association")),
      .shift_profile = read_shift_profile_config(section.section("shift_profile")),
      .alignment = read_rigid_alignment_config(section.section("alignment")),
      .degeneracy = read_degeneracy_config(section.section("degeneracy")),
      .drift = read_drift_config(section.section("drift")),
      .rounds = read_rounds(section.section("rounds")),
      .acceptance = read_acceptance_config(section.section("acceptance")),
      .confirmation = read_start_confirmation_config(section.section("confirmation")),
      .first_place = read_first_place_config(section.section("first_place")),
      .found_start = read_found_start_config(section.section("found_start")),
      .place_doubt = read_place_doubt_config(section.section("place_doubt")),
      .recent_keyframes = section.integer("recent_keyframes", 1, 1000),
      .covariance_inflation = read_covariance_inflation(section.section("covariance_inflation")),
      .corrections = read_correction_config(section.section("corrections"))};
}

}  // namespace fleetloc
