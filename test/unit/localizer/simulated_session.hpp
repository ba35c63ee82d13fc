#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/session_localizer.hpp"
#include "cloud/locate/pyramid_config.hpp"
#include "deploy/sim/room/simulated_run.hpp"
#include "shared/core/counter_random.hpp"
#include "shared/model/session.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// The values of deploy/config/cloud.yaml.
SessionLocalizer::Config localizer_config();

/// Of a room or a yard.
inline constexpr PyramidConfig kSmallPyramid{
    .min_cell_m = 0.25, .max_cell_m = 0.5, .cells = 400, .levels = 6, .level_from = 0.9};

/// The simulated room as a laser map, with noise; made once.
std::shared_ptr<const LaserMap> room_map();

/// The room twice, the second one `apart`; of that one what `has_too` says of points of the first.
std::shared_ptr<const LaserMap> two_rooms(
    const Eigen::Vector3d& apart,
    const std::function<bool(const Eigen::Vector3d&)>& has_too = [](const auto&) { return true; });

LaserMap map_of(const std::vector<Eigen::Vector3d>& points, double noise_m, std::uint64_t seed);

/// Standard deviations of a start pose: 0.2 m along each axis, 1 deg tilt, 3 deg yaw.
Matrix6d start_covariance();

/// A session of a robot in the simulated room, whose frame is the map: submaps made from the truth,
/// with noise drawn from the covariances they state.
class SimulatedSession {
 public:
  struct Config {
    std::uint64_t seed = 1;
    double keyframe_rate_hz = 3.0;
    int features_per_keyframe = 80;
    double pixel_sigma = 0.7;
    double edge_sigma_rad = 0.002;
    double edge_sigma_m = 0.01;
    double start_offset_m = 0.3;                           ///< horizontal, direction by the seed
    double start_yaw_rad = 0.052;                          ///< sign by the seed
    Eigen::Vector3d begin_odom = Eigen::Vector3d::Zero();  ///< of the session [m]
    double off_map_share = 0.0;  ///< of the landmarks, which stand up to a metre before the walls
    bool send_landmarks = false;
    /// Noise of u_left, v and u_right, as the factors have it; otherwise that of SimulatedRun.
    bool noise_of_right_pixel = false;
    /// Only landmarks of which this is true are observed, if it is given.
    std::function<bool(const Eigen::Vector3d& p_map)> is_wanted = {};
  };

  explicit SimulatedSession(const Config& config);

  [[nodiscard]] RobotSession session() const;

  /// One keyframe, and the edge to its predecessor.
  [[nodiscard]] Submap submap(int keyframe) const;

  [[nodiscard]] Pose truth(int keyframe) const;  ///< T_map_body
  [[nodiscard]] Pose truth(KeyframeId keyframe) const { return truth(static_cast<int>(keyframe)); }
  [[nodiscard]] Pose T_odom_body(int keyframe) const;
  [[nodiscard]] const SimulatedRun& run() const { return run_; }

 private:
  [[nodiscard]] VirtualEdge edge_to(int keyframe) const;
  [[nodiscard]] std::vector<StereoObservation> observations(int keyframe) const;
  [[nodiscard]] bool is_off_map(LandmarkId id) const;

  Config config_;
  SimulatedRun run_;
  Pose T_map_odom_;
};

/// Squared error of an answer against the truth by its covariance; 6 on average if that is
/// consistent.
double nees(const LocalizationResult& answer, const Pose& truth);
double position_error(const LocalizationResult& answer, const Pose& truth);  ///< [m]
double rotation_error(const LocalizationResult& answer, const Pose& truth);  ///< [rad]

}  // namespace fleetloc
