#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "robot/inertial/imu_factor.hpp"
#include "robot/vio/marginalization.hpp"
#include "robot/vio/sliding_window.hpp"
#include "robot/vio/triangulation.hpp"
#include "robot/vio/window_corrections.hpp"
#include "robot/vio/window_estimate.hpp"
#include "shared/factors/normal_equations.hpp"
#include "shared/factors/reprojection_factor.hpp"

namespace fleetloc {

/// Parameter blocks and measurements of a keyframe.
struct GraphKeyframe {
  KeyframeId id{};
  Timestamp stamp;
  PoseParameters pose{};
  SpeedBiasParameters speed_bias{};
  std::optional<PoseParameters> first_pose;  ///< set once it is part of the prior
  std::optional<SpeedBiasParameters> first_speed_bias;
  std::vector<StereoObservation> observations;
  std::optional<Preintegration> from_previous;  ///< none for the first of a window
};

struct GraphLandmark {
  PointParameters p_odom{};
  int observations = 0;  ///< keyframes of the window that see it
  bool triangulated = false;

  /// Takes part in the optimization: one stereo observation alone does not constrain a pose.
  [[nodiscard]] bool is_active() const { return triangulated && observations > 1; }
};

/// The factor graph of a window: states, measurements and prior.
struct WindowGraph {
  RectifiedStereo stereo;
  std::deque<GraphKeyframe> keyframes;  // deque and map: stable addresses
  std::map<LandmarkId, GraphLandmark> landmarks;
  std::unique_ptr<MarginalizationPrior> prior;
  WindowCorrections corrections;
};

NavState state_of(const GraphKeyframe& keyframe);

/// Null if `id` is not among them (which are increasing by landmark).
const StereoObservation* find_observation(const std::vector<StereoObservation>& observations,
                                          LandmarkId id);

/// One term of the cost; the parameters are owned by the graph.
struct GraphFactor {
  std::unique_ptr<ceres::CostFunction> cost;
  std::vector<const double*> parameters;
};

/// A reprojection error with its keyframe and landmark.
struct VisualFactor {
  GraphFactor factor;
  std::size_t keyframe = 0;
  LandmarkId landmark{};
};

ResidualBlock block_of(const GraphFactor& factor, const ceres::LossFunction* loss = nullptr);
/// There must be a prior.
ResidualBlock block_of(const MarginalizationPrior& prior);

/// Adds a keyframe and counts its observations. New landmarks are not triangulated yet.
void append(WindowGraph& graph, GraphKeyframe keyframe);

/// Triangulates the inactive landmarks at the current poses.
void triangulate_inactive(WindowGraph& graph, const TriangulationLimits& limits);

/// Preintegrates again where the bias has moved too far for a first-order correction.
void relinearize_preintegrations(WindowGraph& graph);

/// An ImuFactor (paper, eq. 2 and 3) between consecutive keyframes.
std::vector<GraphFactor> inertial_factors(WindowGraph& graph);

/// Reprojection errors (paper, eq. 1) of all active landmarks.
std::vector<VisualFactor> visual_factors(WindowGraph& graph, double pixel_sigma);

/// Minimizes the cost by Levenberg-Marquardt (Ceres), with yaw and position of the oldest keyframe
/// fixed. Corrections have the robust kernel of the reprojection errors, because the cloud's
/// association may be wrong.
WindowDiagnostics optimize(WindowGraph& graph, const SlidingWindow::Config& config);

/// Drops observations beyond `outlier_sigmas`, and landmarks without observations. Returns the
/// number of observations dropped.
int remove_outliers(WindowGraph& graph, const SlidingWindow::Config& config);

/// Marginal of all keyframes, 15 unknowns each (NavState's tangent at the current states), relative
/// to yaw and position of the oldest, from the robot's own measurements: without corrections.
struct OdometryMarginal {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd mean;  ///< their optimum from the current states, to first order
};
OdometryMarginal odometry_marginal(WindowGraph& graph, const SlidingWindow::Config& config);

/// Marginalizes the oldest keyframe and the landmarks that it sees and the newest one does not: all
/// their observations become the prior of the rest. Other landmarks lose their observation in it.
/// Corrections on marginalized states are dropped; none enters the prior.
void marginalize_oldest(WindowGraph& graph, const SlidingWindow::Config& config);

}  // namespace fleetloc
