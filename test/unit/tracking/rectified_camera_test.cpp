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
