#include "cloud/localizer/place_doubt.hpp"

namespace fleetloc {

// Where the scene has changed less of it fits, too, and one gets used to that. What lies outside of
// the map says nothing new.
bool PlaceDoubt::is_elsewhere(const Association& recent) {
  constexpr double kWindows = 120.0;  // that it takes to get used to it
  const int covered = recent.covered - recent.level;
  if (covered < config_.min_landmarks) return is_elsewhere_;
  const double agreement = static_cast<double>(recent.informative_matches()) / covered;
  const double usual = usual_agreement_.value_or(agreement);
  usual_agreement_ = usual + (agreement - usual) / kWindows;
  is_surely_here_ = agreement >= config_.sure_agreement * usual;
  is_elsewhere_ = agreement < (is_lost_ ? config_.sure_agreement : config_.min_agreement) * usual;
  return is_elsewhere_;
}

void PlaceDoubt::take(const std::optional<Rejection>& rejection, double travelled_m) {
  was_localized_ = was_localized_ || !rejection;
  const PlaceEvidence evidence = rejection ? evidence_of(*rejection) : PlaceEvidence::kFor;
  if (evidence == PlaceEvidence::kNone) return;
  if (evidence == PlaceEvidence::kFor) {
    is_lost_ = is_lost_ && rejection;  // it takes a localization to take that back
    if (is_surely_here_) since_m_.reset();
    return;
  }
  if (!since_m_) since_m_ = travelled_m;
  const double way_m = was_localized_ ? config_.way_m : config_.start_way_m;
  is_lost_ = is_lost_ || travelled_m - *since_m_ >= way_m;
}

PlaceDoubt::Config read_place_doubt_config(ConfigReader section) {
  return {.way_m = section.positive("way_m"),
          .start_way_m = section.positive("start_way_m"),
          .min_agreement = section.number("min_agreement", 0.0, 1.0),
          .sure_agreement = section.number("sure_agreement", 0.0, 1.0),
          .min_landmarks = section.integer("min_landmarks", 1, 10000)};
}

}  // namespace fleetloc
