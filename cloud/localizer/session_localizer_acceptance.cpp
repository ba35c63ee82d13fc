// Acceptance of a localization by its matches.
#include <algorithm>
#include <cmath>

#include "cloud/localizer/session_localizer.hpp"

namespace fleetloc {

LocalizationStatus SessionLocalizer::check_matches() const {
  using enum LocalizationStatus;
  const auto& acceptance = config_.acceptance;
  const auto share_of = [](double share, int count) {
    return static_cast<int>(std::ceil(share * count));
  };
  if (association_.covered <
      std::max(acceptance.min_matches,
               share_of(acceptance.min_covered_share, association_.eligible))) {
    return kNoMapCoverage;
  }
  const auto matches = static_cast<int>(association_.matches.size());
  const bool agree = association_.informative_matches() >=
                     acceptance.min_agreement * association_.informative_landmarks();
  return matches >= acceptance.min_matches && agree ? kLocalized : kTooFewMatches;
}

// Snow and leaves raise the ground that most landmarks are on, but nothing lowers it: in a window
// that was aligned to the snow, landmarks of cleared paths are below ground.
bool SessionLocalizer::is_under_ground() const {
  const int ground = association_.level + association_.below_ground;
  return association_.below_ground > config_.acceptance.max_below_ground_share * ground;
}

// A wrong pose often has matches, but also landmarks off the map or occluded by it.
bool SessionLocalizer::is_confident() const {
  const auto& acceptance = config_.acceptance;
  const auto matched = static_cast<double>(association_.matches.size());
  const int against = association_.eligible - association_.covered + 2 * association_.occluded;
  return matched - against >= acceptance.confident_balance * association_.eligible &&
         association_.informative_matches() >= acceptance.confident_matches &&
         association_.informative_matches() >=
             acceptance.confident_agreement * association_.informative_landmarks();
}

}  // namespace fleetloc
