// What the matches of a window say of the place where they were found.
#include <algorithm>
#include <cmath>

#include "cloud/localizer/session_localizer.hpp"

namespace fleetloc {

LocalizationStatus SessionLocalizer::check_matches() const {
  using enum LocalizationStatus;
  const auto& least = config_.acceptance;
  const auto share_of = [](double share, int count) {
    return static_cast<int>(std::ceil(share * count));
  };
  if (association_.covered <
      std::max(least.least_matches, share_of(least.least_covered_share, association_.eligible))) {
    return kNoMapCoverage;
  }
  const auto matches = static_cast<int>(association_.matches.size());
  const bool agree =
      association_.telling_matches() >= least.least_agreement * association_.telling_landmarks();
  return matches >= least.least_matches && agree ? kLocalized : kTooFewMatches;
}

// Snow and leaves lift the ground that most landmarks are on, but nothing lowers what is left of
// it: a window that fits the snow has the cleared ways under the ground.
bool SessionLocalizer::is_under_ground() const {
  const int ground = association_.level + association_.buried;
  return association_.buried > config_.acceptance.max_buried_share * ground;
}

// A wrong start often finds surfaces to match, but not without contradicting others.
bool SessionLocalizer::is_sure() const {
  const auto& sure = config_.acceptance;
  const auto matched = static_cast<double>(association_.matches.size());
  const int against = association_.eligible - association_.covered + 2 * association_.hidden;
  return matched - against >= sure.sure_balance * association_.eligible &&
         association_.telling_matches() >= sure.sure_matches &&
         association_.telling_matches() >= sure.sure_agreement * association_.telling_landmarks();
}

}  // namespace fleetloc
