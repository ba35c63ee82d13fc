#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include "cloud/localizer/landmark_placement.hpp"
#include "cloud/localizer/map_match.hpp"
#include "cloud/localizer/session_database.hpp"
#include "cloud/localizer/window_system.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/factors/parameters.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

class SlotPool;

/// E_loc over one window (paper, eq. 16): stereo reprojection (eq. 1), virtual odometry, map
/// matches (eq. 13 and 14), the tilt of the oldest keyframe and at most one pose prior, over poses
/// and landmarks in `map`.
///
/// The problem lives on between submaps: synchronize() takes out what left the window and puts in
/// what is new. Ceres orders parameters by their addresses, so they lie in pools with fixed slots:
/// one sequence of calls gives one result, bit by bit.
class WindowProblem {
 public:
  struct Config {
    double pixel_sigma_px;       ///< of u_left, v and u_right
    double reprojection_kernel;  ///< Huber, in standard deviations
    double map_kernel;           ///< Cauchy, in standard deviations
    bool use_tilt;               ///< roll and pitch of the oldest keyframe
    double map_tilt_sigma_rad;   ///< of the map's z axis against gravity
    int max_landmarks;           ///< further ones are left out
  };

  struct Solved {
    bool is_usable = false;
    int iterations = 0;
    double cost = 0.0;
  };

  WindowProblem(RectifiedStereo stereo, int max_keyframes, const Config& config);
  ~WindowProblem();
  WindowProblem(const WindowProblem&) = delete;
  WindowProblem& operator=(const WindowProblem&) = delete;

  /// Updates the problem to the keyframes of `poses` (T_map_body): matches of landmarks that left
  /// are removed, and so is the prior. New landmarks start at placed_landmarks().
  void synchronize(const SessionDatabase& database, const std::map<KeyframeId, Pose>& poses);

  void set_matches(const std::vector<MapMatch>& matches);

  /// @param information  of the right perturbation of T_map_body; may be singular
  void set_prior(KeyframeId keyframe, const Pose& T_map_body, const Matrix6d& information);
  void clear_prior();

  /// Moves all poses and landmarks: x_map becomes T_new_old * x_map.
  void move(const Pose& T_new_old);

  /// @param min_decrease  relative, of the cost; a step that lowers it by less is the last
  Solved solve(int max_iterations, double min_decrease);

  [[nodiscard]] Pose pose(KeyframeId id) const;
  [[nodiscard]] std::map<KeyframeId, Pose> poses() const;
  [[nodiscard]] bool has(LandmarkId landmark) const { return landmarks_.contains(landmark); }
  [[nodiscard]] LandmarkPositions positions() const;
  /// With their covariances, in the order of their ids.
  [[nodiscard]] std::vector<WindowLandmark> landmarks() const;
  [[nodiscard]] int observations() const { return observations_; }

  /// Everything in the problem, linearized at the present values.
  [[nodiscard]] WindowSystem system() const;
  /// The covariance of T_map_body of `keyframe` without the map and the prior, relative to a fixed
  /// keyframe `origin`: the growth of the odometry's uncertainty from there. Zero if both are the
  /// same, nothing if the system is singular.
  [[nodiscard]] std::optional<Matrix6d> covariance_from(KeyframeId origin,
                                                        KeyframeId keyframe) const;

 private:
  struct KeyframeNode {
    double* pose = nullptr;
    double pixel_sigma_px = 0.0;
    std::vector<StereoObservation> observations;
    std::vector<ceres::ResidualBlockId> factors;  // of observations; null: left out
  };
  struct EdgeNode {
    VirtualEdge edge;
    ceres::ResidualBlockId factor = nullptr;
  };
  using EdgeKey = std::pair<KeyframeId, KeyframeId>;  // from, to
  using Edges = std::map<EdgeKey, const VirtualEdge*>;
  struct LandmarkNode {
    double* point = nullptr;
    int observations = 0;
    std::optional<MapMatch> match;
    ceres::ResidualBlockId map_factor = nullptr;
  };

  void remove_edges(const Edges& wanted);
  void remove_keyframes(const SessionDatabase& database, const std::map<KeyframeId, Pose>& poses);
  void add_keyframes(const SessionDatabase& database, const std::map<KeyframeId, Pose>& poses);
  void add_edges(const Edges& wanted);
  void add_observations(const LandmarkPositions& positions);
  void add_observation(KeyframeNode& keyframe, std::size_t index);
  std::map<LandmarkId, LandmarkNode>::iterator remove_landmark(
      std::map<LandmarkId, LandmarkNode>::iterator landmark);
  void add_tilt(const SubmapKeyframe& oldest);
  void set_match(LandmarkNode& landmark, const MapMatch* match);
  /// Edges and observations: what the robot measured.
  [[nodiscard]] std::vector<ceres::ResidualBlockId> robot_factors() const;
  /// Tilt, prior and map.
  [[nodiscard]] std::vector<ceres::ResidualBlockId> other_factors() const;
  [[nodiscard]] ResidualBlock block_of(ceres::ResidualBlockId id) const;
  [[nodiscard]] std::optional<Matrix6d> marginal(const std::vector<ceres::ResidualBlockId>& ids,
                                                 KeyframeId keyframe,
                                                 std::optional<KeyframeId> fixed) const;

  RectifiedStereo stereo_;
  Config config_;
  PoseManifold manifold_;
  ceres::HuberLoss reprojection_loss_;
  ceres::CauchyLoss map_loss_;
  std::unique_ptr<SlotPool> pose_pool_;
  std::unique_ptr<SlotPool> point_pool_;
  ceres::Problem problem_;
  std::map<KeyframeId, KeyframeNode> keyframes_;
  std::map<EdgeKey, EdgeNode> edges_;
  std::map<LandmarkId, LandmarkNode> landmarks_;
  ceres::ResidualBlockId tilt_ = nullptr;
  ceres::ResidualBlockId prior_ = nullptr;
  int observations_ = 0;
};

WindowProblem::Config read_window_problem_config(ConfigReader section);

}  // namespace fleetloc
