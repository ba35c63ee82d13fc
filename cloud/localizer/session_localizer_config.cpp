#include "cloud/localizer/session_localizer.hpp"

namespace fleetloc {
namespace {

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
      .database = {.window = section.integer("window", 2, 1000),
                   .blind_s = section.positive("blind_s"),
                   .loose_edge_m = section.positive("loose_edge_m")},
      .registration = read_window_registration_config(section),
      .drift = read_drift_config(section.section("drift")),
      .acceptance = read_acceptance_config(section.section("acceptance")),
      .confirmation = read_start_confirmation_config(section.section("confirmation")),
      .first_place = read_first_place_config(section.section("first_place")),
      .found_start = read_found_start_config(section.section("found_start")),
      .place_doubt = read_place_doubt_config(section.section("place_doubt")),
      .covariance_inflation = read_covariance_inflation(section.section("covariance_inflation")),
      .corrections = read_correction_config(section.section("corrections"))};
}

}  // namespace fleetloc
