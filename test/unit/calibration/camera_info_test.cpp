#include "robot/calibration/camera_info.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "robot/tracking/rectified_camera.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

const Pose kT_body_cam0{.R = exp_so3({0.3, -1.2, 0.4}), .p = {0.05, -0.02, 0.1}};

void set_rotation(CameraInfo& info, const Eigen::Matrix3d& R) {
  for (std::size_t i = 0; i < 9; ++i) {
    info.R[i] = R(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
  }
}

CameraInfo info(double baseline_m) {
  CameraInfo info{
      .width_px = 848,
      .height_px = 480,
      .distortion_model = "plumb_bob",
      .D = {0.0, 0.0, 0.0, 0.0, 0.0},
      .K = {425.0, 0.0, 421.0, 0.0, 426.0, 239.0, 0.0, 0.0, 1.0},
      .P = {420.0, 0.0, 424.0, -420.0 * baseline_m, 0.0, 420.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0}};
  set_rotation(info, Eigen::Matrix3d::Identity());
  return info;
}

std::string_view refusal_of(const CameraInfo& left, const CameraInfo& right) {
  const auto calibration = stereo_calibration(left, right, ImageKind::kRaw, kT_body_cam0);
  return calibration ? "none" : name(calibration.error());
}

TEST(CameraInfo, OfARectifiedPairIsItsProjectionAndBaseline) {
  CameraInfo left = info(0.0);
  left.D = {0.1, 0.2, 0.3, 0.4, 0.5};  // of the image before, whatever it is
  const auto calibration =
      stereo_calibration(left, info(0.095), ImageKind::kRectified, kT_body_cam0);
  ASSERT_TRUE(calibration);
  EXPECT_EQ(calibration->cam0.focal_px, Eigen::Vector2d(420.0, 420.0));
  EXPECT_EQ(calibration->cam1.center_px, Eigen::Vector2d(424.0, 240.0));
  EXPECT_EQ(calibration->cam0.coefficients, Eigen::Vector4d::Zero());
  const Pose T_cam0_cam1 = inverse(calibration->T_body_cam0) * calibration->T_body_cam1;
  EXPECT_LT((T_cam0_cam1.p - Eigen::Vector3d(0.095, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((log_so3(T_cam0_cam1.R)).norm(), 1e-12);
}

// A point goes into both raw images by K, D and R, and comes out where P puts it.
TEST(CameraInfo, OfARawPairAgreesWithItsOwnRectification) {
  for (const std::string model : {"plumb_bob", "equidistant"}) {
    CameraInfo left = info(0.0);
    CameraInfo right = info(0.095);
    for (CameraInfo* one : {&left, &right}) {
      one->distortion_model = model;
      one->D = {-0.05, 0.02, 1e-3, -5e-4};
    }
    const Eigen::Quaterniond R_rectified_cam0 = exp_so3({0.01, -0.02, 0.005});
    const Eigen::Quaterniond R_rectified_cam1 = exp_so3({-0.015, 0.01, 0.008});
    set_rotation(left, R_rectified_cam0.toRotationMatrix());
    set_rotation(right, R_rectified_cam1.toRotationMatrix());
    const auto calibration = stereo_calibration(left, right, ImageKind::kRaw, kT_body_cam0);
    ASSERT_TRUE(calibration);
    const Eigen::Vector3d p_rectified(0.4, -0.3, 2.0);
    const Eigen::Vector3d p_body =
        kT_body_cam0 * Eigen::Vector3d(R_rectified_cam0.conjugate() * p_rectified);
    const Eigen::Vector3d p_cam1 = inverse(calibration->T_body_cam1) * p_body;
    const Eigen::Vector3d expected =
        R_rectified_cam1.conjugate() * (p_rectified - Eigen::Vector3d(0.095, 0.0, 0.0));
    EXPECT_LT((p_cam1 - expected).norm(), 1e-12) << model;
    // In our own rectified pair the disparity is that of the depth, and rows are the same.
    const RectifiedStereo stereo = rectified(*calibration);
    EXPECT_NEAR(stereo.baseline_m, 0.095, 1e-12);
    const RectifiedCamera cam0(calibration->cam0, calibration->T_body_cam0.R, stereo);
    const RectifiedCamera cam1(calibration->cam1, calibration->T_body_cam1.R, stereo);
    const auto pixel_of = [](const Camera& camera, const Eigen::Vector3d& p_cam) {
      return project(camera, p_cam)->cast<float>().eval();
    };
    const Eigen::Vector2f u0 =
        pixel_of(calibration->cam0, R_rectified_cam0.conjugate() * p_rectified);
    const Eigen::Vector2f u1 = pixel_of(calibration->cam1, p_cam1);
    const auto in_left = cam0.rectify({u0.x(), u0.y()});
    const auto in_right = cam1.rectify({u1.x(), u1.y()});
    ASSERT_TRUE(in_left && in_right);
    EXPECT_NEAR(in_left->y(), in_right->y(), 1e-3) << model;
    const Eigen::Vector3d p_rectified_left = inverse(stereo.T_body_cam0) * p_body;
    EXPECT_NEAR(in_left->x() - in_right->x(),
                stereo.focal_px * stereo.baseline_m / p_rectified_left.z(),
                1e-3)
        << model;
  }
}

TEST(CameraInfo, IsRefusedByName) {
  const CameraInfo left = info(0.0);
  const CameraInfo right = info(0.095);
  EXPECT_EQ(refusal_of(left, right), "none");
  EXPECT_EQ(refusal_of(left, left), "baseline");
  EXPECT_EQ(refusal_of(right, left), "not_a_pair");  // left and right exchanged
  const auto broken = [&](auto change) {
    CameraInfo changed = right;
    change(changed);
    return refusal_of(left, changed);
  };
  EXPECT_EQ(broken([](CameraInfo& it) { it.width_px = 0; }), "size");
  EXPECT_EQ(broken([](CameraInfo& it) { it.height_px = 1U << 31U; }), "size");
  EXPECT_EQ(broken([](CameraInfo& it) { it.K[2] = std::nan(""); }), "not_finite");
  EXPECT_EQ(broken([](CameraInfo& it) { it.P[3] = std::numeric_limits<double>::infinity(); }),
            "not_finite");
  EXPECT_EQ(broken([](CameraInfo& it) { it.K[0] = 0.0; }), "focal_length");
  EXPECT_EQ(broken([](CameraInfo& it) { it.distortion_model = "fov"; }), "distortion_model");
  EXPECT_EQ(broken([](CameraInfo& it) { it.D = {0.1, 0.2}; }), "distortion_coefficients");
  EXPECT_EQ(broken([](CameraInfo& it) { it.D.back() = 0.01; }), "distortion_coefficients");
  EXPECT_EQ(broken([](CameraInfo& it) { it.R[1] = 0.1; }), "rotation");
  EXPECT_EQ(broken([](CameraInfo& it) { it.R = {}; }), "rotation");
  EXPECT_EQ(broken([](CameraInfo& it) { it.P[6] = 241.0; }), "not_a_pair");
  EXPECT_EQ(broken([](CameraInfo& it) { it.P[3] = 420.0 * 0.095; }), "baseline");
}

}  // namespace
}  // namespace fleetloc
