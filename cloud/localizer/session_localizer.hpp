#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/degeneracy.hpp"
#include "cloud/localizer/map_association.hpp"
#include "cloud/localizer/map_correction.hpp"
#include "cloud/localizer/nearest_neighbor_cache.hpp"
#include "cloud/localizer/pose_anchor.hpp"
#include "cloud/localizer/rigid_alignment.hpp"
#include "cloud/localizer/session_database.hpp"
#include "cloud/localizer/start_confirmation.hpp"
#include "cloud/localizer/window_problem.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Diagnostics of one localization.
struct LocalizationDiagnostics {
  int keyframes = 0;     ///< in the window
  int landmarks = 0;     ///< in the window
  int observations = 0;  ///< of them
  int eligible = 0;      ///< landmarks known well enough to be matched
  int covered = 0;       ///< of these, with the map around them
  int level = 0;         ///< of the matches, on level surfaces
  int occluded = 0;      ///< see Association
  int below_ground = 0;  ///< see Association
  int matches = 0;       ///< of these, in the last round
  int planar_matches = 0;
  int rounds = 0;                ///< of association and optimization
  int iterations = 0;            ///< of all rounds
  double gate_m = 0.0;           ///< of the first round, or of the alignment before it
  bool aligned = false;          ///< the window was aligned as one rigid body first
  double cost = 0.0;             ///< E_loc at the end
  double median_residual = 0.0;  ///< of the matches, in standard deviations
  double moved_sigmas = 0.0;     ///< Mahalanobis distance from what odometry predicted
  int weak_directions = 0;
  Vector6d map_sigmas_m = Vector6d::Zero();  ///< see MapConstraint
};

/// One session of one robot: collects its submaps and localizes its newest keyframe in the laser
/// map. The window's older keyframes and their matches carry the pose from one submap to the next.
/// What leaves the window is dropped, not marginalized: the map itself constrains what stays.
/// Directions that the map does not constrain are held by a prior at the newest localized keyframe.
///
/// Deterministic, no threads, no clock.
class SessionLocalizer {
 public:
  struct Rounds {
    double final_gate_m;
    double tracking_gate_m;  ///< of the first round, once the pose is known
    double widest_gate_m;    ///< of the alignment, however uncertain the prior
    double gate_sigmas;      ///< width of the first gate, in sigmas of the prior
    double shrink;           ///< of the gate from round to round
    int max_rounds;
    int iterations;    ///< of the solver, in each round
    double settled_m;  ///< converged: a round at the final gate moved less
  };
  struct Acceptance {
    int min_keyframes;
    int min_matches;
    double min_covered_share;  ///< of the eligible landmarks
    double min_agreement;      ///< matched share of the landmarks that are not on the ground
    /// A first localization needs no confirmation if the matched share of the landmarks off the
    /// ground is at least this,
    double confident_agreement;
    int confident_matches;          ///< by at least this many matches, and
    double confident_balance;       ///< (matched - unmapped - 2 occluded) / eligible at least this
    double max_below_ground_share;  ///< of the landmarks on or under level ground
    double max_median_residual;     ///< of the matches, in standard deviations
    double innovation_gate_sigmas;  ///< from what odometry predicts
    double innovation_floor_m;      ///< added to the sigmas of that prediction
    double innovation_floor_rad;
    double innovation_gate_growth;  ///< relative, with each answer in a row that it alone rejects
    double max_weak_sigma_m;        ///< of the answer, along weak directions
  };
  struct CovarianceInflation {
    double scale;    ///< of the standard deviations that the system states
    double floor_m;  ///< added to them: systematic errors of map and stereo pair
    double floor_rad;
    double min_prior_sigma_m;  ///< of the prior along weak directions
  };
  struct Config {
    SessionDatabase::Config database;
    WindowProblem::Config problem;
    AssociationConfig association;
    RigidAlignment::Config alignment;
    DegeneracyConfig degeneracy;
    DriftConfig drift;
    Rounds rounds;
    Acceptance acceptance;
    StartConfirmation::Config confirmation;
    CovarianceInflation covariance_inflation;
    CorrectionConfig corrections;
  };

  SessionLocalizer(const RobotSession& session,
                   std::shared_ptr<const LaserMap> map,
                   const Config& config);

  void add(const Submap& submap);

  /// Localizes the newest keyframe; at least one submap must have been added. Robot, session,
  /// localizer, incarnation, acknowledgements and holding time of the answer are the caller's. A
  /// rejection leaves the stored solution as it was.
  LocalizationResult localize();

  /// What the map has added to the robot's own estimate of its latest keyframes. Nothing unless
  /// localize() has just localized, or if the map added nothing. Robot, session, localizer and
  /// incarnation are the caller's.
  [[nodiscard]] std::optional<Correction> correction() const;

  /// The window behind the last answer; nothing unless localize() has just localized.
  [[nodiscard]] const std::optional<WindowSystem>& system() const { return system_; }
  [[nodiscard]] const LocalizationDiagnostics& diagnostics() const { return diagnostics_; }
  [[nodiscard]] const SessionDatabase& database() const { return database_; }
  /// Counts of all items since the start.
  [[nodiscard]] const SessionDatabase::Added& added() const { return added_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  // The prior on one pose of the window.
  struct PosePrior {
    KeyframeId keyframe{};
    PoseWithCovariance estimate;
  };

  struct PathPoint {
    Eigen::Vector3d p_odom;
    double travelled_m;
  };

  void measure_path();
  LocalizationStatus localize_window(const std::vector<KeyframeId>& window,
                                     PoseWithCovariance& result);
  [[nodiscard]] PosePrior pose_prior_of(const std::vector<KeyframeId>& window) const;
  void align(const PosePrior& pose_prior);
  LocalizationStatus optimize(const PosePrior& pose_prior);
  LocalizationStatus run_round(const PosePrior& pose_prior, double gate_m);
  void set_prior(const PosePrior& pose_prior);
  [[nodiscard]] double gate_for(const PoseWithCovariance& estimate) const;
  void measure_fit();
  [[nodiscard]] LocalizationStatus check_matches() const;
  [[nodiscard]] bool is_under_ground() const;
  [[nodiscard]] bool is_confident() const;
  LocalizationStatus check_result(const PosePrior& pose_prior, PoseWithCovariance& result);
  [[nodiscard]] double innovation_gate() const;
  [[nodiscard]] PoseWithCovariance predicted(KeyframeId keyframe) const;
  bool add_weak_directions(const PosePrior& pose_prior, PoseWithCovariance& result) const;
  void store(const PoseWithCovariance& result);

  std::shared_ptr<const LaserMap> map_;
  Config config_;
  SessionDatabase database_;
  WindowProblem problem_;
  RigidAlignment alignment_;
  NearestNeighborCache nearest_;
  StartConfirmation start_;
  std::optional<PoseAnchor> anchor_;      // none: there is no start pose
  const Eigen::Vector3d begin_odom_;      // of the path: where the start pose was known
  std::map<KeyframeId, PathPoint> path_;  // of the odometry, at the stored keyframes
  int refused_in_a_row_ = 0;              // for the innovation gate alone
  Association association_;               // of the last round
  MapConstraint constraint_;              // of the last round
  std::optional<WindowSystem> system_;    // of the last localization, if it succeeded
  SessionDatabase::Added added_;
  LocalizationDiagnostics diagnostics_;
};

SessionLocalizer::Config read_session_localizer_config(ConfigReader section);

}  // namespace fleetloc
