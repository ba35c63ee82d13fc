#include "robot/vio/sliding_window.hpp"

#include <array>
#include <cassert>
#include <cmath>

#include <Eigen/Cholesky>

#include "robot/vio/gauge_factor.hpp"
#include "robot/vio/state_jacobians.hpp"
#include "robot/vio/window_graph.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr Eigen::Index kState = 15;

// Prior before any measurement: biases around zero.
std::unique_ptr<MarginalizationPrior> bias_prior(const GraphKeyframe& oldest,
                                                 const SlidingWindow::Config& config) {
  PriorState state{oldest.speed_bias.data(), Eigen::VectorXd::Zero(9)};
  state.first.head<3>() = Eigen::Map<const Eigen::Vector3d>(oldest.speed_bias.data());
  Eigen::VectorXd information = Eigen::VectorXd::Zero(9);
  information.segment<3>(3).setConstant(std::pow(config.gyroscope_bias_sigma, -2));
  information.segment<3>(6).setConstant(std::pow(config.accelerometer_bias_sigma, -2));
  return std::make_unique<MarginalizationPrior>(std::vector<PriorState>{std::move(state)},
                                                Eigen::MatrixXd(information.asDiagonal()),
                                                Eigen::VectorXd::Zero(9));
}

GraphKeyframe graph_keyframe(const KeyframeInput& input, const NavState& state) {
  GraphKeyframe keyframe;
  keyframe.id = input.id;
  keyframe.stamp = input.frame.stamp;
  keyframe.pose = to_parameters(state.T_odom_body);
  keyframe.speed_bias = to_speed_bias(state);
  keyframe.observations = input.frame.observations;
  return keyframe;
}

// Covariance of a keyframe's state relative to yaw and position of the oldest one, of that of all
// states: without the sigma that the gauge factor leaves to these.
Matrix15d relative_to_oldest(const Eigen::MatrixXd& covariance,
                             const WindowGraph& graph,
                             std::size_t index) {
  const Pose T_oldest = pose_from(graph.keyframes.front().pose.data());
  const auto at = kState * static_cast<Eigen::Index>(index);
  const Eigen::Matrix<double, kState, 6> J =
      jacobian_by_yaw_and_position(T_oldest, state_of(graph.keyframes[index])) *
      yaw_and_position_jacobian(T_oldest);
  const Matrix15d common = J * covariance.block<6, kState>(0, at);
  return covariance.block<kState, kState>(at, at) - common - common.transpose() +
         J * covariance.topLeftCorner<6, 6>() * J.transpose();
}

// One axis of roll and pitch, from the covariance of the tangent.
double tilt_sigma(const Pose& T_odom_body, const Eigen::Matrix3d& rotation_covariance) {
  const Eigen::Matrix3d R = T_odom_body.R.toRotationMatrix();
  const Eigen::Matrix3d covariance_odom = R * rotation_covariance * R.transpose();
  return std::sqrt(0.5 * (covariance_odom(0, 0) + covariance_odom(1, 1)));
}

// Sigma of depth / depth in `newest`, poses taken as known.
double relative_depth_sigma(const Eigen::Matrix3d& information,
                            const Eigen::Vector3d& p_odom,
                            const Pose& T_odom_cam0) {
  const Eigen::Vector3d axis = T_odom_cam0.R * Eigen::Vector3d::UnitZ();
  const double depth = axis.dot(p_odom - T_odom_cam0.p);
  return std::sqrt(axis.dot(information.ldlt().solve(axis))) / depth;
}

// J^T J of one observation by its landmark.
Eigen::Matrix3d point_information(const StereoObservation& seen,
                                  const GraphKeyframe& keyframe,
                                  const GraphLandmark& landmark,
                                  const RectifiedStereo& stereo,
                                  double pixel_sigma) {
  const std::array parameters{keyframe.pose.data(), landmark.p_odom.data()};
  Eigen::Vector3d r;
  Eigen::Matrix<double, 3, 3, Eigen::RowMajor> J;
  J.setZero();
  std::array<double*, 2> jacobians{nullptr, J.data()};
  if (seen.disparity > 0.0) {
    StereoReprojectionFactor(seen, stereo, {pixel_sigma})
        .Evaluate(parameters.data(), r.data(), jacobians.data());
  } else {
    MonoReprojectionFactor(seen, stereo, {pixel_sigma})
        .Evaluate(parameters.data(), r.data(), jacobians.data());
  }
  return J.transpose() * J;
}

std::map<LandmarkId, LandmarkEstimate> landmark_estimates(const WindowGraph& graph,
                                                          double pixel_sigma) {
  struct Known {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Pose T_odom_cam0;  // newest
  };
  std::map<LandmarkId, Known> known;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    const Pose T_odom_cam0 = pose_from(keyframe.pose.data()) * graph.stereo.T_body_cam0;
    for (const StereoObservation& seen : keyframe.observations) {
      const GraphLandmark& landmark = graph.landmarks.at(seen.landmark);
      if (landmark.triangulated) {
        Known& one = known[seen.landmark];
        one.information += point_information(seen, keyframe, landmark, graph.stereo, pixel_sigma);
        one.T_odom_cam0 = T_odom_cam0;
      }
    }
  }
  std::map<LandmarkId, LandmarkEstimate> estimates;
  for (const auto& [id, one] : known) {
    const GraphLandmark& landmark = graph.landmarks.at(id);
    const Eigen::Vector3d p_odom(landmark.p_odom.data());
    estimates[id] = {p_odom,
                     landmark.observations,
                     relative_depth_sigma(one.information, p_odom, one.T_odom_cam0)};
  }
  return estimates;
}

}  // namespace

struct SlidingWindow::State {
  Config config;
  ImuNoise noise;  // inflated
  WindowGraph graph;
  Eigen::Matrix4d oldest_drift = Eigen::Matrix4d::Zero();  // covariance of its yaw and position
  WindowEstimate estimate;

  void append_predicted(const KeyframeInput& input);
  WindowDiagnostics solve();
  [[nodiscard]] MergeCount take_over(const std::optional<Correction>& correction);
  void report(const WindowDiagnostics& diagnostics, const OdometryMarginal& marginal);
  void slide(const Eigen::MatrixXd& covariance);
  void optimize_and_slide(int rounds);
};

void SlidingWindow::State::append_predicted(const KeyframeInput& input) {
  const NavState last = state_of(graph.keyframes.back());
  Preintegration preintegration(input.imu, last.bias, noise, input.standstill);
  GraphKeyframe keyframe = graph_keyframe(input, preintegration.predict(last));
  keyframe.from_previous = std::move(preintegration);
  append(graph, std::move(keyframe));
}

WindowDiagnostics SlidingWindow::State::solve() {
  const TriangulationLimits limits{config.min_disparity_px, config.max_depth_m};
  triangulate_inactive(graph, limits);
  WindowDiagnostics diagnostics = optimize(graph, config);
  diagnostics.outliers_removed = remove_outliers(graph, config);
  triangulate_inactive(graph, limits);
  return diagnostics;
}

MergeCount SlidingWindow::State::take_over(const std::optional<Correction>& correction) {
  if (!correction.has_value()) {
    return {};
  }
  return config.merge ? merge(*correction, graph) : MergeCount{0, size_of(*correction)};
}

void SlidingWindow::State::report(const WindowDiagnostics& diagnostics,
                                  const OdometryMarginal& marginal) {
  const Eigen::MatrixXd& covariance = marginal.covariance;
  estimate = {};
  estimate.diagnostics = diagnostics;
  Eigen::Index row = 0;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    const NavState state = state_of(keyframe);
    estimate.keyframes.push_back({keyframe.id,
                                  keyframe.stamp,
                                  state,
                                  keyframe.observations,
                                  tilt_sigma(state.T_odom_body, covariance.block<3, 3>(row, row))});
    estimate.inertial.states.push_back(state);
    if (keyframe.from_previous.has_value()) {
      estimate.inertial.between.push_back(*keyframe.from_previous);
    }
    row += kState;
  }
  estimate.inertial.oldest_covariance = covariance.block<9, 9>(6, 6);
  // The cloud's corrections have moved it; its tilt and velocity must not carry them into submaps.
  NavState& oldest = estimate.inertial.states.front();
  oldest = retract(oldest, marginal.mean.head<kState>());
  estimate.landmarks = landmark_estimates(graph, config.noise.pixel_sigma);
  const auto J = jacobian_by_yaw_and_position(estimate.keyframes.front().state.T_odom_body,
                                              estimate.keyframes.back().state);
  estimate.covariance = relative_to_oldest(covariance, graph, graph.keyframes.size() - 1) +
                        J * oldest_drift * J.transpose();
}

// The next keyframe becomes the fixed one: its covariance relative to the oldest adds to the drift.
void SlidingWindow::State::slide(const Eigen::MatrixXd& covariance) {
  const Pose T_oldest = pose_from(graph.keyframes[0].pose.data());
  const Pose T_next = pose_from(graph.keyframes[1].pose.data());
  const auto A = yaw_and_position_jacobian(T_next);
  Eigen::Matrix4d carried = Eigen::Matrix4d::Identity();
  carried.block<3, 1>(1, 0) = Eigen::Vector3d::UnitZ().cross(T_next.p - T_oldest.p);
  oldest_drift = carried * oldest_drift * carried.transpose() +
                 A * relative_to_oldest(covariance, graph, 1).topLeftCorner<6, 6>() * A.transpose();
  marginalize_oldest(graph, config);
}

void SlidingWindow::State::optimize_and_slide(int rounds) {
  WindowDiagnostics diagnostics = solve();
  for (int i = 1; i < rounds; ++i) {
    const int removed = diagnostics.outliers_removed;
    diagnostics = solve();
    diagnostics.outliers_removed += removed;
  }
  const OdometryMarginal marginal = odometry_marginal(graph, config);
  diagnostics.converged = diagnostics.converged && marginal.covariance.allFinite();
  report(diagnostics, marginal);
  if (graph.keyframes.size() >= static_cast<std::size_t>(config.keyframes)) {
    slide(marginal.covariance);
  }
}

SlidingWindow::SlidingWindow(const RectifiedStereo& stereo,
                             const ImuNoise& noise,
                             const Config& config,
                             const Initialization& initialization)
    : state_(std::make_unique<State>()) {
  constexpr int kRounds = 2;  // the second without the outliers of the first
  const auto& keyframes = initialization.keyframes;
  assert(keyframes.size() > 1 && keyframes.size() == initialization.states.size());
  state_->config = config;
  state_->noise = inflated(noise, config.noise);
  state_->graph.stereo = stereo;
  state_->oldest_drift = initialization.drift;
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    GraphKeyframe keyframe = graph_keyframe(keyframes[i], initialization.states[i]);
    if (i > 0) {
      keyframe.from_previous.emplace(
          keyframes[i].imu, initialization.states[i - 1].bias, state_->noise);
    }
    append(state_->graph, std::move(keyframe));
  }
  state_->graph.prior = bias_prior(state_->graph.keyframes.front(), config);
  state_->optimize_and_slide(kRounds);
}

SlidingWindow::~SlidingWindow() = default;
SlidingWindow::SlidingWindow(SlidingWindow&&) noexcept = default;
SlidingWindow& SlidingWindow::operator=(SlidingWindow&&) noexcept = default;

const WindowEstimate& SlidingWindow::estimate() const {
  return state_->estimate;
}

WindowEstimate SlidingWindow::add(const KeyframeInput& keyframe) {
  state_->append_predicted(keyframe);
  if (keyframe.forgets_corrections) forget_corrections(state_->graph);
  const MergeCount merged = state_->take_over(keyframe.correction);
  state_->optimize_and_slide(1);
  state_->estimate.diagnostics.corrections_applied = merged.applied;
  state_->estimate.diagnostics.corrections_ignored = merged.ignored;
  return state_->estimate;
}

SlidingWindow::Config read_sliding_window_config(ConfigReader section, const VioNoise& noise) {
  SlidingWindow::Config config;
  config.noise = noise;
  config.keyframes = section.integer("keyframes", 3, 50);
  config.iterations = section.integer("iterations", 1, 100);
  config.huber_sigmas = section.positive("huber_sigmas");
  config.outlier_sigmas = section.positive("outlier_sigmas");
  config.min_disparity_px = section.positive("min_disparity_px");
  config.max_depth_m = section.positive("max_depth_m");
  config.gyroscope_bias_sigma = section.positive("gyroscope_bias_sigma");
  config.accelerometer_bias_sigma = section.positive("accelerometer_bias_sigma");
  config.merge = section.get<bool>("merge");
  return config;
}

}  // namespace fleetloc
