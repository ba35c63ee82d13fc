#include "test/unit/vio/simulated_correction.hpp"

#include <random>

namespace fleetloc {

Correction SimulatedCloud::correction(const SimulatedRun& run, const WindowEstimate& window) const {
  std::vector<Keyframe> keyframes;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    keyframes.push_back({keyframe.id, keyframe.stamp});
  }
  std::vector<LandmarkId> landmarks;
  for (const auto& [id, landmark] : window.landmarks) {
    if (landmark.observations > 2) landmarks.push_back(id);
  }
  return correction(run, keyframes, landmarks);
}

Correction SimulatedCloud::correction(const SimulatedRun& run, const WindowGraph& graph) const {
  std::vector<Keyframe> keyframes;
  for (const GraphKeyframe& keyframe : graph.keyframes) {
    keyframes.push_back({keyframe.id, keyframe.stamp});
  }
  std::vector<LandmarkId> landmarks;
  for (const auto& [id, landmark] : graph.landmarks) {
    if (landmark.observations > 2) landmarks.push_back(id);
  }
  return correction(run, keyframes, landmarks);
}

Correction SimulatedCloud::correction(const SimulatedRun& run,
                                      const std::vector<Keyframe>& keyframes,
                                      const std::vector<LandmarkId>& landmarks) const {
  std::mt19937_64 random(seed + 1000 * static_cast<std::uint64_t>(keyframes.back().id));
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  const auto draw = [&](double sigma) {
    const Eigen::Vector3d drawn = Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
    return Eigen::Vector3d((noise ? sigma : 0.0) * drawn);
  };
  Correction result;
  result.anchor = keyframes.back().id;
  const Pose T_anchor_room = inverse(run.truth(keyframes.back().stamp).T_odom_body);
  for (const LandmarkId id : landmarks) {
    Eigen::Vector3d p = scale * (T_anchor_room * run.landmark(id)) + draw(landmark_sigma_m);
    if (uniform(random) < outlier_share) {
      p += Eigen::Vector3d::NullaryExpr([&] { return 2.0 * uniform(random) - 1.0; });
    }
    const double weight = 1.0 / (landmark_sigma_m * landmark_sigma_m);
    result.landmarks.push_back({id, p, weight * Eigen::Matrix3d::Identity()});
  }
  Vector6d sigmas;
  sigmas << Eigen::Vector3d::Constant(rotation_sigma_rad),
      Eigen::Vector3d::Constant(translation_sigma_m);
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    Pose T = inverse(run.truth(keyframes[i - 1].stamp).T_odom_body) *
             run.truth(keyframes[i].stamp).T_odom_body;
    T.p *= scale;
    Vector6d error;
    error << draw(rotation_sigma_rad), draw(translation_sigma_m);
    result.relative_poses.push_back({keyframes[i - 1].id,
                                     keyframes[i].id,
                                     retract(T, error),
                                     Matrix6d(sigmas.cwiseAbs2().cwiseInverse().asDiagonal())});
  }
  return result;
}

}  // namespace fleetloc
