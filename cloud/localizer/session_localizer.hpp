#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/laser_map/map_regions.hpp"
#include "cloud/localizer/acceptance.hpp"
#include "cloud/localizer/dead_reckoning.hpp"
#include "cloud/localizer/first_place.hpp"
#include "cloud/localizer/found_start.hpp"
#include "cloud/localizer/localization_diagnostics.hpp"
#include "cloud/localizer/map_correction.hpp"
#include "cloud/localizer/map_fit.hpp"
#include "cloud/localizer/place_doubt.hpp"
#include "cloud/localizer/prediction.hpp"
#include "cloud/localizer/session_database.hpp"
#include "cloud/localizer/window_registration.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/expected.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// One session of one robot: collects its submaps and localizes its newest keyframe in the laser
/// map. The window's older keyframes and their matches carry the pose from one submap to the next.
/// What has left the window is summed up by a prior of its oldest keyframe: the answer that this
/// keyframe had when it was the newest one, with which the window shares nothing but it.
///
/// Its first windows rest on few surfaces, which may fit elsewhere as well. Until a keyframe that
/// was localized has left the window, its place is therefore looked for anew on the way, as far
/// from it as the start pose leaves room.
///
/// A session without a start pose begins with a search over the whole map (FirstPlace), one of
/// which it is known roughly with a search around there. What it finds is a guess (FoundStart): the
/// search goes on until something is localized from it. A session whose place is no longer
/// believed (PlaceDoubt) is lost: what was seen since its last localization is searched for, too,
/// and begins anew from where it is found.
///
/// Deterministic, no threads, no clock.
class SessionLocalizer {
 public:
  struct CovarianceInflation {
    double floor_m;  ///< added to the standard deviations: systematic errors of map and stereo pair
    double floor_rad;
    /// The same, of the prior. The errors of map and stereo pair that an earlier answer has met are
    /// partly those of the window.
    double prior_floor_m;
    double prior_floor_rad;
    /// No start pose counts as better along any axis: that of a robot which another localizer has
    /// localized rests on the keyframes that the window has, too.
    double start_floor_m;
    double start_floor_rad;
  };
  struct Config {
    SessionDatabase::Config database;
    WindowRegistration::Config registration;
    DriftConfig drift;
    Acceptance::Config acceptance;
    StartConfirmation::Config confirmation;
    FirstPlace::Config first_place;
    FoundStart::Config found_start;
    PlaceDoubt::Config place_doubt;
    CovarianceInflation covariance_inflation;
    CorrectionConfig corrections;
  };

  /// @param pyramid  of the map; null: a session without a start pose is never localized
  /// @param where    part of the map, if the session has a region
  SessionLocalizer(const RobotSession& session,
                   std::shared_ptr<const LaserMap> map,
                   const Config& config,
                   std::shared_ptr<const MapPyramid> pyramid = nullptr,
                   const std::optional<MapRegion>& where = std::nullopt);

  void add(const Submap& submap);

  /// Starts with what the robot has sent of this session before, when it had another start.
  void take_over(const SessionDatabase& database);

  /// Localizes the newest keyframe; at least one submap must have been added. Robot, session,
  /// localizer, incarnation, acknowledgements and holding time of the answer are the caller's. A
  /// rejection leaves the stored solution as it was.
  LocalizationResult localize();

  /// Whether a search goes on with the next localize(), also if nothing new is added before it:
  /// then it does nothing else, unless a place is found.
  [[nodiscard]] bool is_searching() const { return first_place_ && first_place_->is_running(); }

  /// Null for a session that has no map to search in.
  [[nodiscard]] const FirstPlace* first_place() const {
    return first_place_ ? &*first_place_ : nullptr;
  }
  /// Where the robot may be, the likeliest first; empty unless what it has seen fits several
  /// places, all of which are known.
  [[nodiscard]] std::vector<PlaceHypotheses::Place> possible_places() const;

  /// What the map has added to the robot's own estimate of its latest keyframes. Nothing unless
  /// localize() has just localized, or if the map added nothing, or if the robot will have gone on
  /// too far. Robot, session, localizer and incarnation are the caller's.
  /// @param round_trip  of the network to the robot
  [[nodiscard]] std::optional<Correction> correction(Duration round_trip = {}) const;

  /// The window behind the last answer; nothing unless localize() has just localized.
  [[nodiscard]] const std::optional<WindowSystem>& system() const { return system_; }
  /// Of the last localize().
  [[nodiscard]] const LocalizationDiagnostics& diagnostics() const { return diagnostics_; }
  [[nodiscard]] const SessionDatabase& database() const { return database_; }
  [[nodiscard]] std::size_t memory_bytes() const;

 private:
  // Poses and landmarks of an accepted window are those of registration_.
  struct Solution {
    PoseWithCovariance newest;  // without the floors
    WindowSystem system;
  };
  // The place of a window, looked for as one rigid body.
  struct Look {
    double travelled_m;
    KeyframeId keyframe;  // of the prior
    Matrix6d rivals;      // see RigidAlignment::Result, of that keyframe
  };

  bool search();
  /// Whether it has a place that was found, and from which nothing was localized so far.
  [[nodiscard]] bool has_found_start() const {
    return found_start_.exists() && !dead_reckoning_.is_localized();
  }
  [[nodiscard]] int places_left() const;
  [[nodiscard]] Rejection not_ready(Rejection reason) const;
  [[nodiscard]] SessionDatabase unexplained() const;
  void begin_search(double travelled_m);
  [[nodiscard]] bool is_held(const Pose& T_map_odom) const;
  void start_at(const Pose& T_map_odom);
  void give_up_found_start();
  void begin_anew(const std::optional<MapOdomEstimate>& start);
  [[nodiscard]] Prediction predict(const std::vector<KeyframeId>& window) const;
  [[nodiscard]] bool is_look_due(const std::vector<KeyframeId>& window) const;
  Look look(const Prediction& prediction);
  void restrain(PosePrior before);
  expected<Solution, Rejection> accept(const Prediction& prediction,
                                       const MapFit& fit,
                                       const std::optional<Look>& looked);
  [[nodiscard]] Matrix6d rivals_of_newest(const Look& looked) const;
  void store(const PoseWithCovariance& newest);
  LocalizationResult localized(Solution solution, const LocalizationDiagnostics& diagnostics);
  LocalizationResult rejected(Rejection reason, const LocalizationDiagnostics& diagnostics);
  [[nodiscard]] LocalizationResult answer(LocalizationStatus status) const;

  std::shared_ptr<const LaserMap> map_;
  Config config_;
  RectifiedStereo stereo_;
  SessionDatabase database_;
  WindowRegistration registration_;
  DeadReckoning dead_reckoning_;
  Acceptance acceptance_;
  std::optional<KeyframeId> localized_until_;
  std::optional<FirstPlace> first_place_;
  FoundStart found_start_;
  double search_way_m_ = 0.0;       // in the window of the search that began last
  std::optional<Look> early_look_;  // the last one, while all that was localized is in the window
  std::optional<WindowSystem> system_;
  bool has_news_ = false;  // since the last localize()
  LocalizationDiagnostics diagnostics_;
};

SessionLocalizer::Config read_session_localizer_config(ConfigReader section);

}  // namespace fleetloc
