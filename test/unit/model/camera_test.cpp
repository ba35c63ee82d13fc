#include "shared/model/camera.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "test/unit/model/euroc_calibration.hpp"

namespace fleetloc {
namespace {

Camera camera_with(Camera::Distortion distortion, const Eigen::Vector4d& coefficients) {
  return {.width_px = 640,
          .height_px = 480,
          .focal_px = {300.0, 310.0},
          .center_px = {320.0, 240.0},
          .distortion = distortion,
          .coefficients = coefficients};
}

void expect_round_trip(const Camera& camera) {
  for (int u = 0; u <= camera.width_px; u += 8) {
    for (int v = 0; v <= camera.height_px; v += 8) {
      const auto direction = unproject(camera, Eigen::Vector2d(u, v));
      ASSERT_TRUE(direction) << u << " " << v;
      EXPECT_EQ(direction->z(), 1.0);
      const auto pixel = project(camera, 3.0 * *direction);
      ASSERT_TRUE(pixel) << u << " " << v;
      EXPECT_LT((*pixel - Eigen::Vector2d(u, v)).norm(), 1e-8) << u << " " << v;
    }
  }
}

TEST(Camera, RoundTripHoldsOverBothEurocImages) {
  expect_round_trip(euroc_calibration().cam0);
  expect_round_trip(euroc_calibration().cam1);
}

TEST(Camera, RoundTripHoldsOverAFisheyeImage) {
  // TUM-VI like lens with a field of view below half a turn.
  expect_round_trip(
      camera_with(Camera::Distortion::kEquidistant, {0.0034, 0.0007, -0.0020, 0.0002}));
}

TEST(Camera, WithoutDistortionIsAPinhole) {
  const Camera camera = camera_with(Camera::Distortion::kRadialTangential, {0, 0, 0, 0});
  const auto pixel = project(camera, {0.5, -0.25, 2.0});
  ASSERT_TRUE(pixel);
  EXPECT_DOUBLE_EQ(pixel->x(), 320.0 + 300.0 * 0.25);
  EXPECT_DOUBLE_EQ(pixel->y(), 240.0 - 310.0 * 0.125);
}

TEST(Camera, RadialTangentialFollowsBrownsFormula) {
  const Camera camera =
      camera_with(Camera::Distortion::kRadialTangential, {-0.2, 0.05, 1e-3, 2e-3});
  const auto pixel = project(camera, {0.3, 0.4, 1.0});  // r^2 = 0.25
  ASSERT_TRUE(pixel);
  const double radial = 1.0 - 0.2 * 0.25 + 0.05 * 0.0625;
  EXPECT_NEAR(pixel->x(), 320.0 + 300.0 * (0.3 * radial + 2.4e-4 + 2e-3 * 0.43), 1e-9);
  EXPECT_NEAR(pixel->y(), 240.0 + 310.0 * (0.4 * radial + 1e-3 * 0.57 + 4.8e-4), 1e-9);
}

TEST(Camera, EquidistantPixelsAreProportionalToTheAngle) {
  const Camera camera = camera_with(Camera::Distortion::kEquidistant, {0, 0, 0, 0});
  const auto pixel = project(camera, {1.0, 0.0, 1.0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 320.0 + 300.0 * std::numbers::pi / 4.0, 1e-12);
  const auto direction = unproject(camera, {320.0, 240.0 + 310.0 * std::numbers::pi / 3.0});
  ASSERT_TRUE(direction);
  EXPECT_NEAR(direction->y(), std::sqrt(3.0), 1e-9);
}

TEST(Camera, SeesNothingBehindIt) {
  const Camera camera = euroc_calibration().cam0;
  EXPECT_FALSE(project(camera, {0.1, 0.1, -1.0}));
  EXPECT_FALSE(project(camera, {0.1, 0.1, 0.0}));
}

TEST(Camera, RefusesPixelsBeyondTheTurningPointOfItsDistortion) {
  // r (1 - 0.3 r^2) turns at r = 1.054, at a distorted radius of 0.703.
  const Camera camera = camera_with(Camera::Distortion::kRadialTangential, {-0.3, 0, 0, 0});
  EXPECT_TRUE(unproject(camera, {320.0 + 300.0 * 0.69, 240.0}));
  EXPECT_FALSE(unproject(camera, {320.0 + 300.0 * 0.72, 240.0}));
  EXPECT_TRUE(project(camera, {1.04, 0.0, 1.0}));
  EXPECT_FALSE(project(camera, {1.07, 0.0, 1.0}));
  EXPECT_FALSE(project(camera, {2.0, 0.0, 1.0}));  // would land inside the image
}

TEST(Camera, RefusesFisheyePixelsThatLookSideways) {
  const Camera camera = camera_with(Camera::Distortion::kEquidistant, {0, 0, 0, 0});
  EXPECT_FALSE(unproject(camera, {320.0 + 300.0 * 1.6, 240.0}));
}

TEST(Camera, RefusesWhatIsNotANumber) {
  for (const auto& camera :
       {euroc_calibration().cam0, camera_with(Camera::Distortion::kEquidistant, {0.1, 0, 0, 0})}) {
    EXPECT_FALSE(unproject(camera, {std::nan(""), 0.0}));
    EXPECT_FALSE(project(camera, {0.0, 0.0, std::nan("")}));
  }
}

/// A point seen by both cameras, brought from their pixels into the rectified pair.
void expect_rectified_agreement(const StereoCalibration& calibration) {
  const RectifiedStereo stereo = rectified(calibration);
  const Eigen::Quaterniond R_rectified_cam0 =
      stereo.T_body_cam0.R.conjugate() * calibration.T_body_cam0.R;
  const Eigen::Quaterniond R_rectified_cam1 =
      stereo.T_body_cam0.R.conjugate() * calibration.T_body_cam1.R;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> lateral(-0.6, 0.6);
  std::uniform_real_distribution<double> depth(0.7, 20.0);
  for (int i = 0; i < 500; ++i) {
    const double z = depth(random);
    const Eigen::Vector3d p_cam0(lateral(random) * z, lateral(random) * z, z);
    const Eigen::Vector3d p_body = calibration.T_body_cam0 * p_cam0;
    const auto left = project(calibration.cam0, p_cam0);
    const auto right = project(calibration.cam1, inverse(calibration.T_body_cam1) * p_body);
    ASSERT_TRUE(left && right);
    const Eigen::Vector3d left_ray = R_rectified_cam0 * unproject(calibration.cam0, *left).value();
    const Eigen::Vector3d right_ray =
        R_rectified_cam1 * unproject(calibration.cam1, *right).value();
    const Eigen::Vector3d left_pixel = project(stereo, left_ray);
    const Eigen::Vector3d right_pixel = project(stereo, right_ray);
    EXPECT_NEAR(left_pixel.y(), right_pixel.y(), 1e-7);
    const Eigen::Vector3d p_rectified = inverse(stereo.T_body_cam0) * p_body;
    EXPECT_NEAR(left_pixel.x() - right_pixel.x(),
                stereo.focal_px * stereo.baseline_m / p_rectified.z(),
                1e-7);
    const Eigen::Vector3d direct = project(stereo, p_rectified);
    EXPECT_NEAR(direct.x(), left_pixel.x(), 1e-7);
    EXPECT_NEAR(direct.y(), left_pixel.y(), 1e-7);
    EXPECT_NEAR(direct.z(), right_pixel.x(), 1e-7);
  }
}

TEST(RectifiedStereo, RowsOfBothEurocCamerasAgree) {
  const StereoCalibration calibration = euroc_calibration();
  const RectifiedStereo stereo = rectified(calibration);
  EXPECT_NEAR(stereo.baseline_m, 0.110, 0.001);
  EXPECT_NEAR(stereo.focal_px, 457.975, 1e-3);
  EXPECT_LT(stereo.T_body_cam0.R.angularDistance(calibration.T_body_cam0.R), 0.05);
  expect_rectified_agreement(calibration);
}

TEST(RectifiedStereo, TakesCamerasAboveEachOther) {
  StereoCalibration calibration = euroc_calibration();
  calibration.T_body_cam1 = calibration.T_body_cam0;
  calibration.T_body_cam1.p += calibration.T_body_cam0.R * Eigen::Vector3d(0.0, 0.2, 0.01);
  expect_rectified_agreement(calibration);
}

TEST(RectifiedStereo, HoldsWideImages) {
  StereoCalibration calibration = euroc_calibration();
  calibration.cam0 = camera_with(Camera::Distortion::kEquidistant, {0, 0, 0, 0});
  calibration.cam0.focal_px.setConstant(400.0);
  calibration.cam0.width_px = 960;
  calibration.cam0.center_px.x() = 480.0;
  calibration.cam1 = calibration.cam0;
  const RectifiedStereo stereo = rectified(calibration);
  EXPECT_LT(stereo.focal_px, 400.0);
  const Eigen::Quaterniond R = stereo.T_body_cam0.R.conjugate() * calibration.T_body_cam0.R;
  const Eigen::Vector3d edge = R * unproject(calibration.cam0, {0.0, 240.0}).value();
  EXPECT_GE(project(stereo, edge).x(), 0.0);
}

TEST(RectifiedStereo, RefusesCamerasBehindEachOther) {
  StereoCalibration calibration = euroc_calibration();
  calibration.T_body_cam1 = calibration.T_body_cam0;
  EXPECT_THROW(rectified(calibration), std::invalid_argument);
  calibration.T_body_cam1.p += calibration.T_body_cam0.R * Eigen::Vector3d::UnitZ();
  EXPECT_THROW(rectified(calibration), std::invalid_argument);
}

}  // namespace
}  // namespace fleetloc
