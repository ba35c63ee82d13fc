#include "robot/tracking/rectified_camera.hpp"

#include <gtest/gtest.h>

#include "test/unit/model/euroc_calibration.hpp"

namespace fleetloc {
namespace {

TEST(RectifiedCamera, RoundTripHoldsOverTheImage) {
  const auto calibration = euroc_calibration();
  const auto stereo = rectified(calibration);
  const RectifiedCamera camera(calibration.cam1, calibration.T_body_cam1.R, stereo);
  for (int v = 0; v < 480; v += 20) {
    for (int u = 0; u < 752; u += 20) {
      const cv::Point2f pixel(static_cast<float>(u), static_cast<float>(v));
      const auto rectified_pixel = camera.rectify(pixel);
      ASSERT_TRUE(rectified_pixel);
      const auto back = camera.distort(*rectified_pixel + Eigen::Vector2d(1e-4, 1e-4));
      if (u > 0 && v > 0) {
        ASSERT_TRUE(back);
        EXPECT_LT(cv::norm(*back - pixel), 1e-3);
      }
    }
  }
}

// Wide-angle: what is beyond the rectified pair's 2048 px is left out, the rest comes back.
TEST(RectifiedCamera, RoundTripHoldsWhereAWideAngleImageFitsThePair) {
  auto calibration = euroc_calibration();
  for (Camera* camera : {&calibration.cam0, &calibration.cam1}) {
    camera->distortion = Camera::Distortion::kEquidistant;
    camera->focal_px = {190.0, 191.0};
    camera->coefficients = {0.0035, 0.0007, -0.0021, 0.0002};
  }
  const auto stereo = rectified(calibration);
  EXPECT_LE(stereo.focal_px, 190.5);
  const RectifiedCamera camera(calibration.cam0, calibration.T_body_cam0.R, stereo);
  int seen = 0;
  for (int v = 10; v < 480; v += 20) {
    for (int u = 10; u < 752; u += 20) {
      const cv::Point2f pixel(static_cast<float>(u), static_cast<float>(v));
      const auto rectified_pixel = camera.rectify(pixel);
      if (!rectified_pixel) continue;
      ++seen;
      const auto back = camera.distort(*rectified_pixel);
      ASSERT_TRUE(back);
      EXPECT_LT(cv::norm(*back - pixel), 1e-3);
    }
  }
  EXPECT_GT(seen, 500);  // of 912
}

TEST(RectifiedCamera, SeesNothingOutsideOfItsImage) {
  const auto calibration = euroc_calibration();
  const auto stereo = rectified(calibration);
  const RectifiedCamera camera(calibration.cam0, calibration.T_body_cam0.R, stereo);
  EXPECT_FALSE(camera.distort({5.0, 1024.0}));
  EXPECT_FALSE(camera.distort({1024.0, 2040.0}));
  EXPECT_TRUE(camera.distort({1024.0, 1024.0}));
}

}  // namespace
}  // namespace fleetloc
