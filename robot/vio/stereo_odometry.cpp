#include "robot/vio/stereo_odometry.hpp"

#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>

#include "robot/vio/pose_alignment.hpp"
#include "robot/vio/triangulation.hpp"

namespace fleetloc {

StereoOdometry::StereoOdometry(RectifiedStereo stereo, const Config& config)
    : stereo_(std::move(stereo)), config_(config) {}

std::optional<Pose> StereoOdometry::add(const TrackedFrame& frame) {
  Pose T_first_body;
  if (started_) {
    const std::optional<Pose> aligned = align(frame);
    if (!aligned.has_value()) {
      return std::nullopt;
    }
    T_first_body = *aligned;
    T_before_last_ = inverse(T_first_last_) * T_first_body;
  }
  T_first_last_ = T_first_body;
  started_ = true;
  for (const StereoObservation& seen : frame.observations) {
    if (seen.disparity >= config_.min_disparity_px && !landmarks_.contains(seen.landmark)) {
      landmarks_[seen.landmark] = T_first_body * triangulate(seen, stereo_);
    }
  }
  return T_first_body;
}

// First with every point under the robust kernel, because the prediction may be far off, then
// with a limit that tightens.
std::optional<Pose> StereoOdometry::align(const TrackedFrame& frame) const {
  std::vector<KnownPoint> points;
  for (const StereoObservation& seen : frame.observations) {
    if (const auto known = landmarks_.find(seen.landmark); known != landmarks_.end()) {
      points.push_back({known->second, seen, config_.pixel_sigma});
    }
  }
  Pose T_first_body = T_first_last_ * T_before_last_;
  PoseSystem system;
  for (const double looser : {std::numeric_limits<double>::infinity(), 4.0, 1.0}) {
    for (int i = 0; i < config_.iterations; ++i) {
      system = linearize(
          points, stereo_, T_first_body, {config_.huber_sigmas, looser * config_.outlier_sigmas});
      if (system.inliers < config_.min_inliers) {
        return std::nullopt;
      }
      T_first_body = retract(T_first_body, -system.H.ldlt().solve(system.g));
    }
  }
  return T_first_body;
}

StereoOdometry::Config read_stereo_odometry_config(ConfigReader section, double pixel_sigma) {
  StereoOdometry::Config config;
  config.pixel_sigma = pixel_sigma;
  config.min_disparity_px = section.positive("min_disparity_px");
  config.huber_sigmas = section.positive("huber_sigmas");
  config.outlier_sigmas = section.positive("outlier_sigmas");
  config.iterations = section.integer("iterations", 1, 100);
  config.min_inliers = section.integer("min_inliers", 6, 1000);
  return config;
}

}  // namespace fleetloc
