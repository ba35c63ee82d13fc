// Both lens models against OpenCV's.
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "shared/model/camera.hpp"

namespace fleetloc {
namespace {

Camera wide_camera_with(Camera::Distortion distortion, const Eigen::Vector4d& coefficients) {
  return {.width_px = 512,
          .height_px = 512,
          .focal_px = {190.9, 191.4},
          .center_px = {254.9, 256.8},
          .distortion = distortion,
          .coefficients = coefficients};
}

cv::Matx33d matrix_of(const Camera& camera) {
  return {camera.focal_px.x(),
          0.0,
          camera.center_px.x(),
          0.0,
          camera.focal_px.y(),
          camera.center_px.y(),
          0.0,
          0.0,
          1.0};
}

cv::Vec4d coefficients_of(const Camera& camera) {
  const Eigen::Vector4d& c = camera.coefficients;
  return {c[0], c[1], c[2], c[3]};
}

/// Over the view up to `tangent` off axis, at several depths.
std::vector<cv::Point3d> points_up_to(double tangent) {
  std::vector<cv::Point3d> points;
  for (int i = -10; i <= 10; ++i) {
    for (int k = -10; k <= 10; ++k) {
      const double depth = 1.0 + 0.1 * (i + 10) + 0.05 * (k + 10);
      points.emplace_back(depth * tangent * i / 10.0, depth * tangent * k / 10.0, depth);
    }
  }
  return points;
}

void expect_same(const Camera& camera,
                 const std::vector<cv::Point3d>& points,
                 const std::vector<cv::Point2d>& pixels) {
  ASSERT_EQ(pixels.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p_cam(points[i].x, points[i].y, points[i].z);
    const Eigen::Vector2d expected(pixels[i].x, pixels[i].y);
    const auto pixel = project(camera, p_cam);
    ASSERT_TRUE(pixel) << p_cam.transpose();
    EXPECT_LT((*pixel - expected).norm(), 1e-9) << p_cam.transpose();
    const auto direction = unproject(camera, expected);
    ASSERT_TRUE(direction) << expected.transpose();
    EXPECT_LT((*direction - p_cam / p_cam.z()).norm(), 1e-8) << expected.transpose();
  }
}

TEST(CameraAndOpenCv, AgreeOnTheEquidistantModelUpToSeventyDegrees) {
  const Camera camera = wide_camera_with(Camera::Distortion::kEquidistant,
                                         {0.0034823, 0.0007150, -0.0020532, 0.0002029});
  const std::vector<cv::Point3d> points = points_up_to(1.95);  // 70 degrees in the corners
  std::vector<cv::Point2d> pixels;
  cv::fisheye::projectPoints(
      points, pixels, cv::Vec3d(), cv::Vec3d(), matrix_of(camera), coefficients_of(camera));
  expect_same(camera, points, pixels);
}

TEST(CameraAndOpenCv, AgreeOnTheRadialTangentialModel) {
  const Camera camera =
      wide_camera_with(Camera::Distortion::kRadialTangential, {-0.28, 0.07, 2e-4, 1.8e-5});
  const std::vector<cv::Point3d> points = points_up_to(0.6);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(
      points, cv::Vec3d(), cv::Vec3d(), matrix_of(camera), coefficients_of(camera), pixels);
  expect_same(camera, points, pixels);
}

}  // namespace
}  // namespace fleetloc
