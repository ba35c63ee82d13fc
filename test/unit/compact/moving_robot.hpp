#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include "shared/geometry/pose.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

inline RectifiedStereo some_stereo() {
  return {.focal_px = 458.0,
          .center_px = {1024.0, 1024.0},
          .baseline_m = 0.11,
          .T_body_cam0 = {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.05, 0.02, -0.01}}};
}

/// A robot that drives and turns past landmarks around it: every keyframe observes those in view,
/// to `noise_px`.
inline Submap moving_robot(std::uint32_t first, int keyframes, double noise_px = 0.2) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-20.0, 20.0);
  std::vector<Eigen::Vector3d> landmarks(600);
  for (auto& p : landmarks) p = {10.0 + place(random), place(random), 0.2 * place(random)};
  std::normal_distribution<double> noise(0.0, noise_px);
  const RectifiedStereo stereo = some_stereo();
  Submap submap;
  submap.robot = "robot_1";
  submap.session = SessionNumber{3};
  submap.incarnation = Incarnation{17};
  submap.number = SampleNumber{40};
  for (int i = 0; i < keyframes; ++i) {
    const double t = 0.5 * (static_cast<double>(first) + i);
    SubmapKeyframe keyframe;
    keyframe.id = KeyframeId{first + static_cast<std::uint32_t>(i)};
    keyframe.stamp = Timestamp{std::chrono::milliseconds(1'000'000 + static_cast<int>(1000 * t))};
    keyframe.T_odom_body = {
        Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * t, Eigen::Vector3d::UnitZ())),
        {3.0 * std::sin(0.2 * t), 3.0 - 3.0 * std::cos(0.2 * t), 0.05 * t}};
    keyframe.tilt_sigma = 0.004;
    const Pose T_cam_odom = inverse(keyframe.T_odom_body * stereo.T_body_cam0);
    for (std::uint32_t id = 0; id < landmarks.size(); ++id) {
      const Eigen::Vector3d p_cam = T_cam_odom * landmarks[id];
      if (p_cam.z() < 1.0) continue;
      const Eigen::Vector3d pixel = project(stereo, p_cam);
      if ((pixel.head<2>() - stereo.center_px).cwiseAbs().maxCoeff() > 300.0) continue;
      keyframe.observations.push_back(
          {.landmark = LandmarkId{5000 + id},
           .left = {pixel.x() + noise(random), pixel.y() + noise(random)},
           .disparity = id % 7 == 0 ? 0.0 : std::max(0.3, pixel.x() - pixel.z() + noise(random))});
    }
    submap.keyframes.push_back(std::move(keyframe));
  }
  for (std::size_t i = 1; i < submap.keyframes.size(); ++i) {
    const SubmapKeyframe& from = submap.keyframes[i - 1];
    const SubmapKeyframe& to = submap.keyframes[i];
    Vector6d error;
    for (Eigen::Index k = 0; k < 6; ++k) error[k] = (k < 3 ? 3e-4 : 4e-3) * noise(random);
    Vector6d information;
    information << Eigen::Vector3d::Constant(1.0 / 1e-7), Eigen::Vector3d(4e4, 4e4, 9e4);
    submap.edges.push_back({.from = from.id,
                            .to = to.id,
                            .revision = Revision{1},
                            .T_from_to = retract(inverse(from.T_odom_body) * to.T_odom_body, error),
                            .information = information.asDiagonal()});
  }
  return submap;
}

}  // namespace fleetloc
