#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "cloud/localizer/answer_covariance.hpp"
#include "cloud/localizer/map_fit.hpp"
#include "cloud/localizer/place_doubt.hpp"
#include "cloud/localizer/pose_with_covariance.hpp"
#include "cloud/localizer/rejection.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/expected.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// The way of the robot by its odometry.
struct TravelledPath {
  double to_oldest_m = 0.0;  ///< until the oldest keyframe of the window
  double to_newest_m = 0.0;  ///< until the newest
  /// In the longest window in which a search has found this place; without limit if it was told.
  double searched_m = std::numeric_limits<double>::infinity();

  [[nodiscard]] double window_m() const { return to_newest_m - to_oldest_m; }
};

/// Accepts the first localization of a session only once it is confirmed. In a scene that has
/// changed a lot, a wrong pose may have enough matches by chance; but as the robot drives on and
/// observes other structure, a wrong T_map_odom changes and the right one stays.
class StartConfirmation {
 public:
  struct Config {
    double path_m;           ///< over which T_map_odom must stay, or the window must reach
    double tolerance_m;      ///< of the position, within which it stays
    double certain_start_m;  ///< sigmas of a start pose that itself confirms a solution within the
    double certain_start_rad;  ///< tolerance: another localizer has localized the robot
    double known_start_m;      ///< sigma beyond which not even a confident place counts at once
    double searched_path_m;    ///< of its search, beyond that sigma: found from less, it is unique
                               ///< by chance
  };

  explicit StartConfirmation(const Config& config) : config_(config) {}

  /// Takes the session's next solution, in the order of its keyframes.
  /// @param travelled_m  by the odometry until then
  /// @param is_confident      the solution needs no confirmation
  /// @return whether this solution and those that follow are accepted
  bool take(const Pose& T_map_body, const Pose& T_odom_body, double travelled_m, bool is_confident);

  /// Whether the start pose itself confirms a solution.
  /// @param predicted  of the newest keyframe by the start pose, with the drift since then
  [[nodiscard]] bool is_vouched_for(const PoseWithCovariance& predicted,
                                    const Pose& T_map_body) const;

  /// Whether a confident solution is the place: the start pose leaves little room for others, or
  /// the window is long.
  /// @param predicted  as above
  [[nodiscard]] bool is_distinct(const PoseWithCovariance& predicted,
                                 const TravelledPath& path) const;

  /// Whether a place that a search has found was found in a window that is long enough for the
  /// room that there is.
  /// @param predicted  as above
  [[nodiscard]] bool is_found_well(const PoseWithCovariance& predicted,
                                   const TravelledPath& path) const;

  /// Of the last solution; nothing once the session is confirmed.
  [[nodiscard]] const std::optional<Pose>& last_T_map_odom() const { return last_T_map_odom_; }

 private:
  struct Candidate {
    Pose T_map_odom;
    double travelled_m;
  };

  Config config_;
  bool confirmed_ = false;
  std::optional<Candidate> candidate_;
  std::optional<Pose> last_T_map_odom_;
};

/// Decides whether a localization becomes an answer, and names the reason if it does not. All
/// thresholds are here; cloud/README.md lists what each protects from, and the test that fails
/// without it. The checks stand in the order of the stages that they follow.
///
/// Remembers what the earlier decisions of its session were.
class Acceptance {
 public:
  struct Config {
    int min_keyframes;
    int min_matches;
    double min_covered_share;       ///< of the eligible landmarks
    double min_agreement;           ///< matched share of the landmarks that are not on the ground
    double max_below_ground_share;  ///< of the landmarks on or under level ground
    double max_start_motion_m;      ///< of a first place in the last round
    double max_median_residual;     ///< of the matches, in standard deviations
    double innovation_gate_sigmas;  ///< from what odometry predicts
    double innovation_floor_m;      ///< added to the sigmas of that prediction
    double innovation_floor_rad;
    double innovation_gate_growth;  ///< relative, with each answer in a row that it alone rejects
    double max_weak_sigma_m;        ///< of the answer, along weak directions
    double max_found_sigma_m;       ///< of a first place that was found, in any direction
    /// A first localization needs no confirmation if the matched share of the landmarks off the
    /// ground is at least this,
    double confident_agreement;
    int confident_matches;     ///< by at least this many matches, and
    double confident_balance;  ///< (matched - unmapped - 2 occluded) / eligible at least this
  };
  using Verdict = expected<void, Rejection>;

  Acceptance(const Config& config,
             const StartConfirmation::Config& confirmation,
             const PlaceDoubt::Config& doubt)
      : config_(config), start_(confirmation), doubt_(doubt) {}

  /// Whether there is enough to begin with.
  [[nodiscard]] Verdict check_window(bool has_start_pose, std::size_t keyframes) const;

  /// After each association: whether the map speaks for the window at all.
  [[nodiscard]] Verdict check_matches(const Association& association) const;

  /// Mahalanobis distance of a pose from what the odometry predicts, with the floors added to that
  /// prediction's covariance.
  [[nodiscard]] double innovation_sigmas(const PoseWithCovariance& predicted,
                                         const Pose& T_map_body) const;

  /// After the rounds: whether this is the place.
  /// @param is_start  nothing was localized before
  Verdict check_fit(const MapFit& fit, bool is_start);

  /// Whether it can be said well enough where in that place the robot is.
  /// @param is_found  as a first place that nobody told, in the whole map
  [[nodiscard]] Verdict check_certainty(const std::optional<AnswerCovariance>& stated,
                                        bool is_found) const;

  /// At last, whether the session's first place is the right one; see StartConfirmation.
  /// @param predicted    of the newest keyframe
  /// @param path         by the odometry until then
  Verdict confirm(const MapFit& fit,
                  const PoseWithCovariance& predicted,
                  const Pose& T_odom_body,
                  const TravelledPath& path);

  /// What became of a window, in the order of their newest keyframes; see PlaceDoubt.
  void conclude(const std::optional<Rejection>& rejection, double travelled_m) {
    doubt_.take(rejection, travelled_m);
  }

  /// Whether the place of the session is no longer believed.
  [[nodiscard]] bool is_lost() const { return doubt_.is_lost(); }

  /// By the last solution, while the session's first place is unconfirmed.
  [[nodiscard]] const std::optional<Pose>& unconfirmed_T_map_odom() const {
    return start_.last_T_map_odom();
  }

 private:
  [[nodiscard]] bool is_below_ground(const Association& association) const;
  [[nodiscard]] double innovation_gate() const;
  [[nodiscard]] bool is_confident(const Association& association) const;

  Config config_;
  int refused_in_a_row_ = 0;  // by the innovation gate alone
  StartConfirmation start_;
  PlaceDoubt doubt_;
};

Acceptance::Config read_acceptance_config(ConfigReader section);
StartConfirmation::Config read_start_confirmation_config(ConfigReader section);

}  // namespace fleetloc
