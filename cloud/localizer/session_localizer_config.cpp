#include "cloud/localizer/session_localizer.hpp"

namespace fleetloc {
namespace {

SessionLocalizer::Rounds read_rounds(ConfigReader section) {
  return {.final_gate_m = section.positive("final_gate_m"),
          .tracking_gate_m = section.positive("tracking_gate_m"),
          .widest_gate_m = section.positive("widest_gate_m"),
          .gate_deviations = section.positive("gate_deviations"),
          .shrink = section.positive("shrink"),
          .most = section.integer("most", 1, 100),
          .iterations = section.integer("iterations", 1, 100),
          .settled_m = section.positive("settled_m")};
}

SessionLocalizer::Acceptance read_acceptance(ConfigReader section) {
  return {.least_keyframes = section.integer("least_keyframes", 1, 1000),
          .least_matches = section.integer("least_matches", 3, 10000),
          .least_covered_share = section.positive("least_covered_share"),
          .least_agreement = section.number("least_agreement", 0.0, 1.0),
          .sure_agreement = section.number("sure_agreement", 0.0, 1.0),
          .sure_matches = section.integer("sure_matches", 0, 10000),
          .sure_balance = section.number("sure_balance", -2.0, 1.0),
          .max_buried_share = section.number("max_buried_share", 0.0, 1.0),
          .max_median_residual = section.positive("max_median_residual"),
          .reach_deviations = section.positive("reach_deviations"),
          .reach_floor_m = section.positive("reach_floor_m"),
          .reach_floor_rad = section.positive("reach_floor_rad"),
          .reach_growth = section.positive("reach_growth"),
          .max_weak_sigma_m = section.positive("max_weak_sigma_m")};
}

SessionLocalizer::Honesty read_honesty(ConfigReader section) {
  return {.scale = section.positive("scale"),
          .floor_m = section.positive("floor_m"),
          .floor_rad = section.positive("floor_rad"),
          .least_prior_sigma_m = section.positive("least_prior_sigma_m")};
}

}  // namespace

SessionLocalizer::Config read_session_localizer_config(ConfigReader section) {
  return {.database = {.window = section.integer("window", 2, 1000)},
          .problem = read_window_problem_config(section.section("problem")),
          .association = read_association_config(section.section("association")),
          .alignment = read_rigid_alignment_config(section.section("alignment")),
          .degeneracy = read_degeneracy_config(section.section("degeneracy")),
          .drift = read_drift_config(section.section("drift")),
          .rounds = read_rounds(section.section("rounds")),
          .acceptance = read_acceptance(section.section("acceptance")),
          .confirmation = read_start_confirmation_config(section.section("confirmation")),
          .honesty = read_honesty(section.section("honesty")),
          .corrections = read_correction_config(section.section("corrections"))};
}

}  // namespace fleetloc
