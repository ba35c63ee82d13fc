#include "cloud/localizer/landmark_placement.hpp"

#include <iostream>
#include <map>
#include <random>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "test/unit/localizer/mean.hpp"

namespace fleetloc {
namespace {

constexpr double kPixelSigma = 0.5;

RectifiedStereo stereo_of_a_robot() {
  RectifiedStereo stereo;
  stereo.focal_px = 450.0;
  stereo.baseline_m = 0.11;
  stereo.center_px = {376.0, 240.0};
  return stereo;
}

/// A landmark seen by cameras that move sideways.
class PlacedLandmark : public testing::Test {
 protected:
  void see(const Eigen::Vector3d& p_map, int keyframes, double step_m, double disparity_sigma) {
    std::normal_distribution<double> normal;
    Submap submap;
    for (int i = 0; i < keyframes; ++i) {
      const KeyframeId id{static_cast<std::uint32_t>(i)};
      Pose& T_map_body = poses_[id];
      T_map_body = Pose{};
      T_map_body.p.x() = step_m * i;
      const Eigen::Vector3d p_cam0 = inverse(T_map_body * stereo_.T_body_cam0) * p_map;
      const double scale = stereo_.focal_px / p_cam0.z();
      StereoObservation seen;
      seen.landmark = LandmarkId{7};
      seen.left = stereo_.center_px + scale * p_cam0.head<2>() +
                  kPixelSigma * Eigen::Vector2d(normal(random_), normal(random_));
      seen.disparity = scale * stereo_.baseline_m + disparity_sigma * normal(random_);
      SubmapKeyframe keyframe{};
      keyframe.id = id;
      keyframe.observations = {seen};
      submap.keyframes.push_back(keyframe);
    }
    database_ = SessionDatabase({.window = keyframes});
    database_.add(submap);
  }

  [[nodiscard]] Eigen::Vector3d placed() const {
    return placed_landmarks(database_, poses_, stereo_).at(LandmarkId{7});
  }

  RectifiedStereo stereo_ = stereo_of_a_robot();
  std::mt19937 random_{1};
  SessionDatabase database_{{.window = 1}};
  std::map<KeyframeId, Pose> poses_;
};

TEST_F(PlacedLandmark, OfOneViewIsWhereItsDisparitySays) {
  see({1.0, 0.5, 8.0}, 1, 0.0, 0.0);
  EXPECT_LT((placed() - Eigen::Vector3d(1.0, 0.5, 8.0)).norm(), 0.03);
}

// The largest of many noisy disparities says that it is nearer by a fifth.
TEST_F(PlacedLandmark, OfManyViewsIsNotTooNear) {
  Mean depth_m;
  for (int i = 0; i < 200; ++i) {
    see({2.0, 0.5, 15.0}, 20, 0.2, kPixelSigma);
    depth_m.add(placed().z());
  }
  std::cout << "mean depth of 15 m: " << depth_m.value() << " m\n";
  EXPECT_NEAR(depth_m.value(), 15.0, 0.1);
}

TEST_F(PlacedLandmark, OfViewsThatNoPointExplainsIsWhereTheNearestSays) {
  see({2.0, 0.5, 15.0}, 2, 0.5, 0.0);
  const Eigen::Vector3d turned_away = Eigen::Vector3d::UnitY();
  poses_.at(KeyframeId{0}).R = Eigen::AngleAxisd(3.0, turned_away);  // it cannot have seen it
  SubmapKeyframe without = database_.keyframe(KeyframeId{0}).item;
  without.observations.front().disparity = 0.0;
  without.revision = Revision{1};
  Submap submap;
  submap.keyframes.push_back(without);
  database_.add(submap);
  EXPECT_NEAR(placed().z(), 15.0, 0.5);
}

}  // namespace
}  // namespace fleetloc
