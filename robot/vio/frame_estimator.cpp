#include "robot/vio/frame_estimator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "robot/inertial/imu_factor.hpp"
#include "robot/vio/pose_alignment.hpp"
#include "robot/vio/state_jacobians.hpp"
#include "shared/core/percentile.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// A state and its covariance relative to a keyframe whose pose is taken as known.
struct LocalState {
  NavState state;
  Matrix15d covariance;
};

// The covariance of the keyframe with its pose taken as known.
Matrix15d speed_bias_only(const Matrix15d& covariance) {
  Matrix15d result = Matrix15d::Zero();
  result.bottomRightCorner<9, 9>() = covariance.bottomRightCorner<9, 9>();
  return result;
}

// The error is zero at the prediction, so second = -J_second^-1 (J_first * first + noise).
LocalState predicted(const NavState& keyframe,
                     const Matrix15d& covariance,
                     const Preintegration& preintegration) {
  const NavState state = preintegration.predict(keyframe);
  const ImuError error = imu_error(preintegration, keyframe, state);
  const Matrix15d J_inverse = error.J_second.partialPivLu().inverse();
  const Matrix15d noise =
      imu_error_covariance(preintegration) + error.J_first * covariance * error.J_first.transpose();
  return {state, J_inverse * noise * J_inverse.transpose()};
}

// The window's landmarks in this frame. Their pixel sigma includes their depth error, which matters
// more the farther the camera has moved since the newest keyframe.
std::vector<KnownPoint> known_points(const TrackedFrame& frame,
                                     const WindowEstimate& window,
                                     const RectifiedStereo& stereo,
                                     const Pose& T_odom_body,
                                     double pixel_sigma) {
  const Pose T_cam0_odom = inverse(T_odom_body * stereo.T_body_cam0);
  const double moved = (window.keyframes.back().state.T_odom_body.p - T_odom_body.p).norm();
  std::vector<KnownPoint> points;
  for (const StereoObservation& seen : frame.observations) {
    const auto found = window.landmarks.find(seen.landmark);
    if (found == window.landmarks.end()) {
      continue;
    }
    const LandmarkEstimate& landmark = found->second;
    const double z = std::max(0.1, (T_cam0_odom * landmark.p_odom).z());
    const double by_depth = stereo.focal_px * moved / z * landmark.relative_depth_sigma;
    const double by_sight = pixel_sigma * pixel_sigma * (1.0 + 1.0 / landmark.observations);
    points.push_back({landmark.p_odom, seen, std::sqrt(by_sight + by_depth * by_depth)});
  }
  return points;
}

// Moves a prediction to the minimum of its own error and the reprojection errors, by Gauss-Newton
// in covariance form: d = -P E (I + H P_66)^-1 b. If prediction and pixel noise are consistent, d^T
// P_66^-1 d is chi-square distributed with at most 6 degrees of freedom.
struct Refinement {
  LocalState state;
  std::vector<LandmarkId> outliers;
  double correction_chi_square = 0.0;
};
Refinement refined_state(const LocalState& prediction,
                         const std::vector<KnownPoint>& points,
                         const RectifiedStereo& stereo,
                         const FrameEstimator::Config& config) {
  const Matrix6d P = prediction.covariance.topLeftCorner<6, 6>();
  Refinement result{prediction, {}, 0.0};
  Vector15d delta = Vector15d::Zero();
  PoseSystem system;
  Matrix6d gain = Matrix6d::Zero();  // (I + H P)^-1
  for (int i = 0; i < config.iterations; ++i) {
    // The first step rejects nothing: the prediction may be off by more than the outlier limit.
    const double outlier_sigmas = i == 0 ? 1e9 : config.outlier_sigmas;
    system = linearize(
        points, stereo, result.state.state.T_odom_body, {config.huber_sigmas, outlier_sigmas});
    gain = (Matrix6d::Identity() + system.H * P).partialPivLu().inverse();
    const Vector6d b = system.g - system.H * delta.head<6>();
    delta = -prediction.covariance.leftCols<6>() * (gain * b);
    result.state.state = retract(prediction.state, delta);
  }
  const Eigen::Matrix<double, 15, 6> C = prediction.covariance.leftCols<6>();
  result.state.covariance = prediction.covariance - C * (gain * system.H) * C.transpose();
  result.outliers = std::move(system.outliers);
  const Vector6d correction = delta.head<6>();
  result.correction_chi_square = correction.dot(P.ldlt().solve(correction));
  return result;
}

// Adds the keyframe's own uncertainty: a wrong keyframe pose moves what follows as a rigid body.
Matrix15d with_keyframe(const LocalState& local,
                        const NavState& keyframe,
                        const Matrix6d& keyframe_covariance) {
  const auto J = jacobian_by_pose(keyframe.T_odom_body, local.state);
  const Matrix15d sum = local.covariance + J * keyframe_covariance * J.transpose();
  return 0.5 * (sum + sum.transpose());
}

// Displacement [px] of what both frames see, as it would be without rotation. Both are increasing
// by landmark.
std::vector<double> parallax(const TrackedFrame& before,
                             const TrackedFrame& now,
                             const RectifiedStereo& stereo,
                             const Eigen::Quaterniond& R_before_now) {
  const Eigen::Matrix3d R_body_cam0 = stereo.T_body_cam0.R.toRotationMatrix();
  const Eigen::Matrix3d R_now_before =
      R_body_cam0.transpose() * R_before_now.toRotationMatrix().transpose() * R_body_cam0;
  std::vector<double> displacements;
  auto old = before.observations.begin();
  for (const StereoObservation& seen : now.observations) {
    while (old != before.observations.end() && old->landmark < seen.landmark) {
      ++old;
    }
    if (old == before.observations.end()) {
      break;
    }
    if (old->landmark == seen.landmark) {
      Eigen::Vector3d ray;
      ray << (old->left - stereo.center_px) / stereo.focal_px, 1.0;
      ray = R_now_before * ray;
      const Eigen::Vector2d turned =
          stereo.center_px + stereo.focal_px * ray.head<2>() / std::max(ray.z(), 1e-3);
      displacements.push_back((seen.left - turned).norm());
    }
  }
  return displacements;
}

}  // namespace

FrameEstimator::FrameEstimator(RectifiedStereo stereo, const ImuNoise& noise, const Config& config)
    : stereo_(std::move(stereo)), noise_(inflated(noise, config.noise)), config_(config) {}

void FrameEstimator::update(std::shared_ptr<const WindowEstimate> window) {
  window_ = std::move(window);
  const WindowKeyframe& newest = window_->keyframes.back();
  if (!reference_.has_value() || reference_->frame.stamp < newest.stamp) {
    reference_ = {{newest.stamp, newest.observations}, newest.state.T_odom_body.R};
  }
}

void FrameEstimator::reset() {
  window_.reset();
  reference_.reset();
}

std::optional<FrameEstimator::Result> FrameEstimator::estimate(const TrackedFrame& frame,
                                                               const ImuBuffer& imu) {
  if (window_ == nullptr || frame.stamp < window_->keyframes.back().stamp) {
    return std::nullopt;
  }
  const WindowKeyframe& newest = window_->keyframes.back();
  Result result;
  result.estimate = {frame.stamp, newest.state, window_->covariance};
  if (frame.stamp > newest.stamp) {
    const std::vector<ImuSample> samples = imu.between(newest.stamp, frame.stamp);
    if (samples.size() < 2) {
      return std::nullopt;
    }
    const Duration standstill = imu.left_out(newest.stamp, frame.stamp);
    LocalState local = predicted(newest.state,
                                 speed_bias_only(window_->covariance),
                                 Preintegration(samples, newest.state.bias, noise_, standstill));
    const std::vector<KnownPoint> points =
        known_points(frame, *window_, stereo_, local.state.T_odom_body, config_.noise.pixel_sigma);
    result.tracked = static_cast<int>(points.size());
    if (result.tracked >= config_.min_tracked) {
      Refinement refinement = refined_state(local, points, stereo_, config_);
      result.outliers = std::move(refinement.outliers);
      const auto outliers = static_cast<int>(result.outliers.size());
      result.correction_chi_square = refinement.correction_chi_square;
      result.vision_inconsistent =
          !(result.correction_chi_square <= config_.max_correction_chi_square) ||
          outliers > config_.max_outlier_share * result.tracked;
      result.vision_updated =
          !result.vision_inconsistent && result.tracked - outliers >= config_.min_tracked;
      if (result.vision_updated) local = refinement.state;
    }
    result.estimate.state = local.state;
    result.estimate.covariance =
        with_keyframe(local, newest.state, window_->covariance.topLeftCorner<6, 6>());
  }
  // Without observations, or with inconsistent ones, a keyframe adds nothing.
  const bool useful = static_cast<int>(frame.observations.size()) >= config_.min_tracked;
  result.wants_keyframe = useful && !result.vision_inconsistent &&
                          wants_keyframe(frame, result.estimate.state.T_odom_body.R);
  return result;
}

void FrameEstimator::set_reference_keyframe(const TrackedFrame& frame, const NavState& state) {
  reference_ = {frame, state.T_odom_body.R};
}

bool FrameEstimator::wants_keyframe(const TrackedFrame& frame,
                                    const Eigen::Quaterniond& R_odom_body) const {
  const double since = to_seconds(frame.stamp - reference_->frame.stamp);
  if (since < config_.min_keyframe_interval_s) {
    return false;
  }
  if (since >= config_.max_keyframe_interval_s) {
    return true;
  }
  std::vector<double> displacements = parallax(
      reference_->frame, frame, stereo_, reference_->R_odom_body.conjugate() * R_odom_body);
  const auto before = static_cast<double>(reference_->frame.observations.size());
  return displacements.empty() ||
         static_cast<double>(displacements.size()) < config_.keyframe_tracked_share * before ||
         *percentile(std::move(displacements), 0.5) > config_.keyframe_parallax_px;
}

FrameEstimator::Config read_frame_estimator_config(ConfigReader section, const VioNoise& noise) {
  FrameEstimator::Config config;
  config.noise = noise;
  config.iterations = section.integer("iterations", 1, 100);
  config.huber_sigmas = section.positive("huber_sigmas");
  config.outlier_sigmas = section.positive("outlier_sigmas");
  config.min_tracked = section.integer("min_tracked", 3, 1000);
  config.max_correction_chi_square = section.positive("max_correction_chi_square");
  config.max_outlier_share = section.positive("max_outlier_share");
  config.keyframe_parallax_px = section.positive("keyframe_parallax_px");
  config.keyframe_tracked_share = section.positive("keyframe_tracked_share");
  config.min_keyframe_interval_s = section.positive("min_keyframe_interval_s");
  config.max_keyframe_interval_s = section.positive("max_keyframe_interval_s");
  return config;
}

}  // namespace fleetloc
