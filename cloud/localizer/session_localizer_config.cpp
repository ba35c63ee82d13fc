#include "cloud/localizer/session_localizer.hpp"

namespace fleetloc {
namespace {

SessionLocalizer::Rounds read_rounds(ConfigReader section) {
  return {.final_gate_m = section.positive("final_gate_m"),
          .tracking_gate_m = section.positive("tracking_gate_m"),
          .widest_gate_m = section.positive("widest_gate_m"),
          .gate_sigmas = section.positive("gate_sigmas"),
          .shrink = section.positive("shrink"),
          .max_rounds = section.integer("max_rounds", 1, 100),
          .iterations = section.integer("iterations", 1, 100),
          .settled_m = section.positive("settled_m")};
}

SessionLocalizer::Acceptance read_acceptance(ConfigReader section) {
  return {.min_keyframes = section.integer("min_keyframes", 1, 1000),
          .min_matches = section.integer("min_matches", 3, 10000),
          .min_covered_share = section.positive("min_covered_share"),
          .min_agreement = section.number("min_agreement", 0.0, 1.0),
          .confident_agreement = section.number("confident_agreement", 0.0, 1.0),
          .confident_matches = section.integer("confident_matches", 0, 10000),
          .confident_balance = section.number("confident_balance", -2.0, 1.0),
          .max_below_ground_share = section.number("max_below_ground_share", 0.0, 1.0),
          .max_median_residual = section.positive("max_median_residual"),
          .innovation_gate_sigmas = section.positive("innovation_gate_sigmas"),
          .innovation_floor_m = section.positive("innovation_floor_m"),
          .innovation_floor_rad = section.positive("innovation_floor_rad"),
          .innovation_gate_growth = section.positive("innovation_gate_growth"),
          .max_weak_sigma_m = section.positive("max_weak_sigma_m")};
}

SessionLocalizer::CovarianceInflation read_covariance_inflation(ConfigReader section) {
  return {.scale = section.positive("scale"),
          .floor_m = section.positive("floor_m"),
          .floor_rad = section.positive("floor_rad"),
          .min_prior_sigma_m = section.positive("min_prior_sigma_m")};
}

}  // namespace

SessionLocalizer::Config read_session_localizer_config(ConfigReader section) {
  return {
      .database = {.window = section.integer("window", 2, 1000)},
      .problem = read_window_problem_config(section.section("problem")),
      .association = read_association_config(section.section("association")),
      .alignment = read_rigid_alignment_config(section.section("alignment")),
      .degeneracy = read_degeneracy_config(section.section("degeneracy")),
      .drift = read_drift_config(section.section("drift")),
      .rounds = read_rounds(section.section("rounds")),
      .acceptance = read_acceptance(section.section("acceptance")),
      .confirmation = read_start_confirmation_config(section.section("confirmation")),
      .covariance_inflation = read_covariance_inflation(section.section("covariance_inflation")),
      .corrections = read_correction_config(section.section("corrections"))};
}

}  // namespace fleetloc
