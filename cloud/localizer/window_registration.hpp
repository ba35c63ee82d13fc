#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/acceptance.hpp"
#include "cloud/localizer/degeneracy.hpp"
#include "cloud/localizer/map_fit.hpp"
#include "cloud/localizer/nearest_neighbor_cache.hpp"
#include "cloud/localizer/prediction.hpp"
#include "cloud/localizer/rigid_alignment.hpp"
#include "cloud/localizer/session_database.hpp"
#include "cloud/localizer/shift_profile.hpp"
#include "cloud/localizer/window_problem.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

/// Registers a session's window with the map: as one rigid body where its place is known too
/// roughly, then by rounds of association and optimization of E_loc (paper, eq. 13 to 16). What two
/// windows share stays, with its solution.
class WindowRegistration {
 public:
  /// When the rounds, and the solver in each of them, have converged.
  struct Convergence {
    int max_rounds;
    int iterations;       ///< of the solver, in each round, at most
    double min_decrease;  ///< relative, of the cost; a step that lowers it by less ends the round
    double settled_m;  ///< a round at the final gate that moved the newest pose by less ends them
  };
  struct Rounds {
    double final_gate_m;
    double tracking_gate_m;   ///< of the first round, once the pose is known
    double widest_gate_m;     ///< of the alignment, however uncertain the prior
    double gate_sigmas;       ///< width of the first gate, in sigmas of the prior
    double shrink;            ///< of the gate from round to round
    double early_look_way_m;  ///< driven until an early window's place is looked for anew
    Convergence tracking;     ///< while the pose is known
    Convergence rough;        ///< otherwise: far from the optimum, steps are many and small
  };
  struct Config {
    WindowProblem::Config problem;
    AssociationConfig association;
    ShiftProfileConfig shift_profile;
    RigidAlignment::Config alignment;
    DegeneracyConfig degeneracy;
    Rounds rounds;
    int recent_keyframes;  ///< the newest ones, of MapFit::recent
  };

  /// @param map            outlives it
  /// @param max_keyframes  of a window
  WindowRegistration(const RectifiedStereo& stereo,
                     const LaserMap& map,
                     int max_keyframes,
                     const Config& config);
  WindowRegistration(const WindowRegistration&) = delete;  // alignment_ refers to config_
  WindowRegistration& operator=(const WindowRegistration&) = delete;

  /// To the keyframes of the window, placed in the map (eq. 12).
  void synchronize(const SessionDatabase& database, const Pose& T_map_odom);

  /// Forgets all windows.
  void clear(const SessionDatabase& database);

  /// As wide as the odometry leaves the landmarks' places in the map uncertain.
  [[nodiscard]] double gate_m(const PoseWithCovariance& prior) const;

  /// The whole window as one rigid body, which is moved to its place.
  /// @param guess  T_map_body of the prior's keyframe, another place to start from
  RigidAlignment::Result align(const PosePrior& prior,
                               double gate_m,
                               const std::optional<Pose>& guess);

  /// By what is known of a pose without the window.
  void restrain(const PosePrior& before);

  /// Rounds with a gate that shrinks, until the window has settled or acceptance will reject it.
  MapFit fit(const Prediction& prediction,
             const SessionDatabase& database,
             const Acceptance& acceptance);

  /// What the window, as it was optimized with these matches, tells of its place beside that.
  [[nodiscard]] ShiftProfile shift_profile(const std::vector<MapMatch>& matches,
                                           bool is_found) const;

  [[nodiscard]] const WindowProblem& problem() const { return problem_; }
  [[nodiscard]] const RigidAlignment& alignment() const { return alignment_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  [[nodiscard]] std::vector<WindowLandmark> recent(const SessionDatabase& database,
                                                   std::vector<WindowLandmark> landmarks) const;

  Config config_;
  const LaserMap& map_;
  WindowProblem problem_;  // lives on from one window to the next
  RigidAlignment alignment_;
  NearestNeighborCache nearest_;
  std::optional<ShiftProfile> shift_profile_;  // of the last window
};

WindowRegistration::Config read_window_registration_config(ConfigReader section);

}  // namespace fleetloc
