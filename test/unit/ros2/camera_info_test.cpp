#include <functional>
#include <limits>

#include "test/unit/ros2/samples.hpp"

namespace fleetloc {
namespace {

using sensor_msgs::msg::dds_::CameraInfo_;

void expect_info_refused(std::string_view reason,
                         const std::function<void(CameraInfo_&)>& corrupt) {
  CameraInfo_ info = from_ros2_cdr<CameraInfo_>(encode(some_camera_info())).value();
  corrupt(info);
  expect_refused(decode_camera_info(to_cdr(info)), reason);
}

TEST(Ros2CameraInfo, RoundTripPreservesEveryField) {
  CameraInfoMessage sent = some_camera_info();
  sent.P[3] = -50.0;
  sent.R[1] = 0.25;
  const CameraInfoMessage received = decode_camera_info(encode(sent)).value();
  EXPECT_EQ(received.header.stamp, sent.header.stamp);
  EXPECT_EQ(received.header.frame, sent.header.frame);
  EXPECT_EQ(received.width_px, sent.width_px);
  EXPECT_EQ(received.height_px, sent.height_px);
  EXPECT_EQ(received.distortion_model, sent.distortion_model);
  EXPECT_EQ(received.coefficients, sent.coefficients);
  EXPECT_EQ(received.K, sent.K);
  EXPECT_EQ(received.R, sent.R);
  EXPECT_EQ(received.P, sent.P);
  EXPECT_EQ(received.binning_x, sent.binning_x);
  EXPECT_EQ(received.binning_y, sent.binning_y);
  EXPECT_EQ(received.region.x_px, sent.region.x_px);
  EXPECT_EQ(received.region.y_px, sent.region.y_px);
  EXPECT_EQ(received.region.width_px, sent.region.width_px);
  EXPECT_EQ(received.region.height_px, sent.region.height_px);
}

TEST(Ros2CameraInfo, ACamerasModelGetsItsRos2Name) {
  Camera camera;
  camera.coefficients = {0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(camera_info(camera, {}).distortion_model, "plumb_bob");
  EXPECT_EQ(camera_info(camera, {}).coefficients, (std::vector{0.1, 0.2, 0.3, 0.4, 0.0}));
  camera.distortion = Camera::Distortion::kEquidistant;
  EXPECT_EQ(camera_info(camera, {}).distortion_model, "equidistant");
  EXPECT_EQ(camera_info(camera, {}).coefficients, (std::vector{0.1, 0.2, 0.3, 0.4}));
}

TEST(Ros2CameraInfo, ABinningOfZeroIsOne) {
  CameraInfo_ info = from_ros2_cdr<CameraInfo_>(encode(some_camera_info())).value();
  info.binning_x(0);
  info.binning_y(0);
  const CameraInfoMessage received = decode_camera_info(to_cdr(info)).value();
  EXPECT_EQ(received.binning_x, 1U);
  EXPECT_EQ(received.binning_y, 1U);
}

TEST(Ros2CameraInfo, WhatIsNotFiniteIsRefused) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  expect_info_refused("not_finite", [](CameraInfo_& info) { info.d()[1] = kNaN; });
  expect_info_refused("not_finite", [](CameraInfo_& info) { info.k()[2] = kNaN; });
  expect_info_refused("not_finite", [](CameraInfo_& info) { info.r()[8] = kNaN; });
  expect_info_refused("not_finite", [](CameraInfo_& info) { info.p()[3] = kNaN; });
}

TEST(Ros2CameraInfo, ACameraWithoutAFocalLengthIsRefused) {
  expect_info_refused("not_calibrated", [](CameraInfo_& info) { info.k({}); });
  expect_info_refused("not_calibrated", [](CameraInfo_& info) { info.k()[4] = -1.0; });
}

TEST(Ros2CameraInfo, AbsurdSizesAreRefused) {
  expect_info_refused("empty_image", [](CameraInfo_& info) { info.width(0); });
  expect_info_refused("too_many_pixels", [](CameraInfo_& info) { info.height(0xFFFF'FFFF); });
}

TEST(Ros2CameraInfo, TooManyCoefficientsAndLongNamesAreRefused) {
  expect_info_refused("out_of_range", [](CameraInfo_& info) { info.d().resize(15); });
  expect_info_refused("long_text",
                      [](CameraInfo_& info) { info.distortion_model(std::string(257, 'a')); });
  expect_info_refused("invalid_stamp", [](CameraInfo_& info) { info.header().stamp().sec(-1); });
}

}  // namespace
}  // namespace fleetloc
