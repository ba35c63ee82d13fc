#pragma once

#include <map>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "cloud/localizer/pose_with_covariance.hpp"
#include "cloud/localizer/session_database.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/ids.hpp"
#include "shared/geometry/pose.hpp"
#include "shared/model/session.hpp"

namespace fleetloc {

/// Drift of the robot's odometry: standard deviations per metre travelled.
struct DriftConfig {
  double translation_m_per_m;
  double rotation_rad_per_m;
};

/// The start pose where it was known; any attitude there will do, since the odometry goes on from
/// it.
PoseWithCovariance pose_where_known(const MapOdomEstimate& start);

/// The pose in the map from which odometry is dead-reckoned: the start pose until the session has
/// been localized, then that of the newest localized keyframe.
struct PoseAnchor {
  std::optional<KeyframeId> keyframe;  ///< none: where the start pose was known
  Pose T_odom_body;          ///< the odometry there, as it was when the keyframe was localized
  double travelled_m = 0.0;  ///< path length of the odometry until then
  PoseWithCovariance estimate;

  /// Dead-reckoned to a later (or earlier) pose of the same session, at path length
  /// `travelled_m_later` [m]. The drift grows with the path length, also around a closed loop.
  [[nodiscard]] PoseWithCovariance at(const Pose& T_odom_later,
                                      double travelled_m_later,
                                      const DriftConfig& drift) const;
};

/// What is known of one keyframe's pose before the window is matched with the map.
struct PosePrior {
  KeyframeId keyframe{};
  PoseWithCovariance estimate;
};

/// Where the odometry says that the robot is in the map: the anchors, the path travelled since, and
/// the drift along it.
class DeadReckoning {
 public:
  /// @param start  of the session; without it there is no anchor
  DeadReckoning(const std::optional<MapOdomEstimate>& start, const DriftConfig& drift);

  /// Measures the path up to each keyframe that is new, on straight lines between keyframes.
  void follow(const std::map<KeyframeId, SessionDatabase::Keyframe>& keyframes);

  /// From here on the odometry is dead-reckoned from this localized keyframe, which may be the one
  /// before, localized again.
  void restart(const SubmapKeyframe& localized, const PoseWithCovariance& estimate);

  [[nodiscard]] bool has_anchor() const { return !anchors_.empty(); }
  [[nodiscard]] bool is_localized() const { return has_anchor() && anchors_.back().keyframe; }

  /// What follows needs an anchor.
  [[nodiscard]] Pose T_map_odom() const;
  [[nodiscard]] PoseWithCovariance at(const SubmapKeyframe& keyframe) const;
  /// The newest anchor itself while it is in the window; once that keyframe has left the window,
  /// dead-reckoned to the window's oldest keyframe. Before the first localization dead-reckoned to
  /// the keyframe that is nearest to the start pose: at the start of a drive the oldest one, but
  /// the newest one of a robot that comes from another localizer with all its keyframes.
  [[nodiscard]] PosePrior prior(const std::vector<KeyframeId>& window,
                                const SessionDatabase& database) const;

  /// What was known without this window, but for one of its keyframes: that of the last anchor that
  /// is not after the window's oldest keyframe, dead-reckoned to it; as long as there is only the
  /// start pose, to the keyframe that is nearest to it.
  [[nodiscard]] PosePrior before(const std::vector<KeyframeId>& window,
                                 const SessionDatabase& database) const;

  /// Whether that is the start pose: all that was localized is in the window.
  [[nodiscard]] bool is_start_before(const std::vector<KeyframeId>& window) const {
    return !anchor_before(window).keyframe;
  }

  /// Path length up to a keyframe of follow(), from where the start pose was known [m]; negative
  /// before it.
  [[nodiscard]] double travelled_m(KeyframeId keyframe) const {
    return path_.at(keyframe).travelled_m;
  }

 private:
  struct PathPoint {
    Eigen::Vector3d p_odom;
    double travelled_m;
  };

  [[nodiscard]] const PoseAnchor& anchor_before(const std::vector<KeyframeId>& window) const;
  /// The anchor, where it does not lie in the window.
  [[nodiscard]] PosePrior carried(const PoseAnchor& anchor,
                                  const std::vector<KeyframeId>& window,
                                  const SessionDatabase& database) const;
  void begin_path(const std::map<KeyframeId, SessionDatabase::Keyframe>& keyframes);

  DriftConfig drift_;
  std::vector<PoseAnchor> anchors_;       // oldest first; those that before() may need
  Eigen::Vector3d begin_odom_;            // of the path
  std::map<KeyframeId, PathPoint> path_;  // at the stored keyframes
};

DriftConfig read_drift_config(ConfigReader section);

}  // namespace fleetloc
