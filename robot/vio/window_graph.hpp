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

/// A keyframe as the optimizer sees it.
struct GraphKeyframe {
  KeyframeId id{};
  Timestamp stamp;
  PoseParameters pose{};
  SpeedBiasParameters speed_bias{};
  std::optional<PoseParameters> first_pose;  ///< once the prior speaks of it
  std::optional<SpeedBiasParameters> first_speed_bias;
  std::vector<StereoObservation> observations;
  std::optional<Preintegration> from_previous;  ///< none for the first of a window
};

struct GraphLandmark {
  PointParameters p_odom{};
  int observations = 0;  ///< keyframes of the window that see it
  bool triangulated = false;

  /// One stereo observation determines a landmark and says nothing else.
  [[nodiscard]] bool takes_part() const { return triangulated && observations > 1; }
};

/// The states of a window and what is known of them.
struct WindowGraph {
  RectifiedStereo stereo;
  std::deque<GraphKeyframe> keyframes;  // a deque and a map: addresses stay
  std::map<LandmarkId, GraphLandmark> landmarks;
  std::unique_ptr<MarginalizationPrior> prior;
  WindowCorrections corrections;
};

NavState state_of(const GraphKeyframe& keyframe);

/// Null if `id` is not among them (which are increasing by landmark).
const StereoObservation* find_observation(const std::vector<StereoObservation>& observations,
                                          LandmarkId id);

/// One term of the cost; the parameters stand in the graph.
struct GraphFactor {
  std::unique_ptr<ceres::CostFunction> cost;
  std::vector<const double*> parameters;
};

/// A reprojection error and where it comes from.
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

/// Triangulates what takes no part in the optimization, at the current poses.
void triangulate_others(WindowGraph& graph, const TriangulationLimits& limits);

/// Preintegrates again where the bias has moved too far for a first-order correction.
void relinearize_preintegrations(WindowGraph& graph);

/// Joins each keyframe to its predecessor.
std::vector<GraphFactor> inertial_factors(WindowGraph& graph);

/// Of all landmarks that take part.
std::vector<VisualFactor> visual_factors(WindowGraph& graph, double pixel_sigma);

/// Ceres, Levenberg-Marquardt, with yaw and position of the oldest keyframe held. Corrections have
/// the robust kernel of the reprojections, for a wrong association in the map shows in them.
WindowDiagnostics optimize(WindowGraph& graph, const SlidingWindow::Config& config);

/// Drops observations beyond `outlier_sigmas`, and landmarks that nobody sees any more.
int remove_outliers(WindowGraph& graph, const SlidingWindow::Config& config);

/// What the robot's own measurements say of all keyframes, 15 unknowns each (NavState's tangent at
/// the current states), relative to yaw and position of the oldest. Without corrections.
struct OdometryMarginal {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd mean;  ///< where they alone would have the states, to first order
};
OdometryMarginal odometry_marginal(WindowGraph& graph, const SlidingWindow::Config& config);

/// The oldest keyframe leaves: with the landmarks that it sees and the newest one does not, all
/// their observations turn into the prior of the rest. Others lose their observation in it.
/// Corrections that concern what leaves are dropped; none enters the prior.
void marginalize_oldest(WindowGraph& graph, const SlidingWindow::Config& config);

}  // namespace fleetloc
