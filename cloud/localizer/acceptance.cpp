#include "cloud/localizer/acceptance.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "shared/geometry/covariance.hpp"

namespace fleetloc {

using enum Rejection;

// Without a start pose nothing says where to look; a few views fit many places.
Acceptance::Verdict Acceptance::check_window(bool has_start_pose, std::size_t keyframes) const {
  if (!has_start_pose) return unexpected(kSearching);
  if (keyframes < static_cast<std::size_t>(config_.min_keyframes)) {
    return unexpected(kTooFewKeyframes);
  }
  return {};
}

Acceptance::Verdict Acceptance::check_matches(const Association& association) const {
  // At the edge of the map, or with a wrong one, little of what the robot sees was surveyed.
  const auto min_covered =
      static_cast<int>(std::ceil(config_.min_covered_share * association.eligible));
  if (association.covered < std::max(config_.min_matches, min_covered)) {
    return unexpected(kNotCovered);
  }
  // A handful fits some surface anywhere.
  if (static_cast<int>(association.matches.size()) < config_.min_matches) {
    return unexpected(kTooFewMatches);
  }
  // Level ground fits everywhere: the other surfaces have to agree.
  if (association.informative_matches() <
      config_.min_agreement * association.informative_landmarks()) {
    return unexpected(kDisagreement);
  }
  return {};
}

Acceptance::Verdict Acceptance::check_fit(const MapFit& fit, bool is_start) {
  if (const Verdict matched = check_matches(fit.association); !matched) return matched;
  if (!fit.is_solved) return unexpected(kNotSolved);
  // Nothing around a first place holds it there while it still moves.
  if (is_start && fit.moved_m > config_.max_start_motion_m) return unexpected(kNotSettled);
  // Next to the right place the matches lie within the gate, but beside the surfaces.
  if (fit.median_residual > config_.max_median_residual) return unexpected(kPoorFit);
  if (is_below_ground(fit.association)) return unexpected(kBelowGround);
  // The older keyframes hold the window where it was, whatever the newest ones see.
  if (doubt_.is_elsewhere(fit.recent)) return unexpected(kRecentDisagreement);
  // Farther than the odometry can have brought the robot. Only the start pose is never given up: it
  // is all that says where the session is.
  if (!(fit.innovation_sigmas <= innovation_gate())) {
    if (!is_start) ++refused_in_a_row_;
    return unexpected(kInnovation);
  }
  return {};
}

// Snow and leaves raise the ground that most landmarks are on, but nothing lowers it: in a window
// that was aligned to the snow, landmarks of cleared paths are below ground.
bool Acceptance::is_below_ground(const Association& association) const {
  const int ground = association.level + association.below_ground;
  return association.below_ground > config_.max_below_ground_share * ground;
}

// The floors are errors of the map between two places, which the odometry does not have.
double Acceptance::innovation_sigmas(const PoseWithCovariance& predicted,
                                     const Pose& T_map_body) const {
  const Matrix6d covariance =
      predicted.covariance +
      diagonal_covariance(config_.innovation_floor_rad, config_.innovation_floor_m);
  const Vector6d moved = local_coordinates(predicted.T_map_body, T_map_body);
  return std::sqrt(moved.dot(covariance.ldlt().solve(moved)));
}

// Grows with each rejection, so that no pose is locked out for ever.
double Acceptance::innovation_gate() const {
  return config_.innovation_gate_sigmas *
         (1.0 + config_.innovation_gate_growth * refused_in_a_row_);
}

Acceptance::Verdict Acceptance::check_certainty(const std::optional<AnswerCovariance>& stated,
                                                bool is_found) const {
  if (!stated) return unexpected(kSingular);
  // As in a corridor that the robot entered without knowing where.
  if (!(stated->weak_sigma_m <= config_.max_weak_sigma_m)) return unexpected(kWeak);
  // Nobody vouches for that place but the search, which knows it to a cell or two.
  const double sigma_m = max_sigma(stated->covariance.bottomRightCorner<3, 3>());
  if (is_found && !(sigma_m <= config_.max_found_sigma_m)) return unexpected(kWeak);
  return {};
}

Acceptance::Verdict Acceptance::confirm(const MapFit& fit,
                                        const PoseWithCovariance& predicted,
                                        const Pose& T_odom_body,
                                        const TravelledPath& path) {
  if (!start_.is_found_well(predicted, path)) return unexpected(kUnconfirmed);
  const bool is_sure = (is_confident(fit.association) && start_.is_distinct(predicted, path)) ||
                       start_.is_vouched_for(predicted, fit.T_map_body);
  if (!start_.take(fit.T_map_body, T_odom_body, path.to_newest_m, is_sure)) {
    return unexpected(kUnconfirmed);
  }
  refused_in_a_row_ = 0;
  return {};
}

// A wrong pose often has matches, but also landmarks off the map or occluded by it.
bool Acceptance::is_confident(const Association& association) const {
  const auto matched = static_cast<double>(association.matches.size());
  const int against = association.eligible - association.covered + 2 * association.occluded;
  return matched - against >= config_.confident_balance * association.eligible &&
         association.informative_matches() >= config_.confident_matches &&
         association.informative_matches() >=
             config_.confident_agreement * association.informative_landmarks();
}

bool StartConfirmation::take(const Pose& T_map_body,
                             const Pose& T_odom_body,
                             double travelled_m,
                             bool is_confident) {
  if (confirmed_) return true;
  // The place where the confirmation began takes the odometry to this solution.
  const bool stays =
      candidate_ &&
      ((candidate_->T_map_odom * T_odom_body).p - T_map_body.p).norm() <= config_.tolerance_m;
  last_T_map_odom_ = T_map_body * inverse(T_odom_body);
  if (!stays) candidate_ = {*last_T_map_odom_, travelled_m};
  confirmed_ = is_confident || travelled_m - candidate_->travelled_m >= config_.path_m;
  if (confirmed_) last_T_map_odom_.reset();
  return confirmed_;
}

// By that of a robot that another localizer has localized; one that was set by hand is not as
// certain.
bool StartConfirmation::is_vouched_for(const PoseWithCovariance& predicted,
                                       const Pose& T_map_body) const {
  const double sigma_rad = max_sigma(predicted.covariance.topLeftCorner<3, 3>());
  const double sigma_m = max_sigma(predicted.covariance.bottomRightCorner<3, 3>());
  return sigma_m <= config_.certain_start_m && sigma_rad <= config_.certain_start_rad &&
         (T_map_body.p - predicted.T_map_body.p).norm() <= config_.tolerance_m;
}

// The more room there is, the more places in it look like the right one from a short way.
bool StartConfirmation::is_distinct(const PoseWithCovariance& predicted,
                                    const TravelledPath& path) const {
  return max_sigma(predicted.covariance.bottomRightCorner<3, 3>()) <= config_.known_start_m ||
         path.window_m() >= config_.path_m;
}

bool StartConfirmation::is_found_well(const PoseWithCovariance& predicted,
                                      const TravelledPath& path) const {
  return max_sigma(predicted.covariance.bottomRightCorner<3, 3>()) <= config_.known_start_m ||
         path.searched_m >= config_.searched_path_m;
}

Acceptance::Config read_acceptance_config(ConfigReader section) {
  return {.min_keyframes = section.integer("min_keyframes", 1, 1000),
          .min_matches = section.integer("min_matches", 3, 10000),
          .min_covered_share = section.positive("min_covered_share"),
          .min_agreement = section.number("min_agreement", 0.0, 1.0),
          .max_below_ground_share = section.number("max_below_ground_share", 0.0, 1.0),
          .max_start_motion_m = section.positive("max_start_motion_m"),
          .max_median_residual = section.positive("max_median_residual"),
          .innovation_gate_sigmas = section.positive("innovation_gate_sigmas"),
          .innovation_floor_m = section.positive("innovation_floor_m"),
          .innovation_floor_rad = section.positive("innovation_floor_rad"),
          .innovation_gate_growth = section.positive("innovation_gate_growth"),
          .max_weak_sigma_m = section.positive("max_weak_sigma_m"),
          .max_found_sigma_m = section.positive("max_found_sigma_m"),
          .confident_agreement = section.number("confident_agreement", 0.0, 1.0),
          .confident_matches = section.integer("confident_matches", 0, 10000),
          .confident_balance = section.number("confident_balance", -2.0, 1.0)};
}

StartConfirmation::Config read_start_confirmation_config(ConfigReader section) {
  return {.path_m = section.positive("path_m"),
          .tolerance_m = section.positive("tolerance_m"),
          .certain_start_m = section.positive("certain_start_m"),
          .certain_start_rad = section.positive("certain_start_rad"),
          .known_start_m = section.positive("known_start_m"),
          .searched_path_m = section.positive("searched_path_m")};
}

}  // namespace fleetloc
