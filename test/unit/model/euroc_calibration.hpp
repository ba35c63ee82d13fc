#pragma once

#include <Eigen/Core>

#include "shared/model/camera.hpp"

namespace fleetloc {

/// Pose of a camera whose x, y and z axes in the body frame are the columns of a rotation, given
/// row by row, rounded as in a calibration file.
inline Pose pose_from_rows(const Eigen::Matrix<double, 3, 4>& rows) {
  Pose pose;
  pose.R = Eigen::Quaterniond(Eigen::Matrix3d(rows.leftCols<3>())).normalized();
  pose.p = rows.col(3);
  return pose;
}

/// The published calibration of the EuRoC MAV's stereo camera.
inline StereoCalibration euroc_calibration() {
  StereoCalibration stereo;
  stereo.cam0 = {.width_px = 752,
                 .height_px = 480,
                 .focal_px = {458.654, 457.296},
                 .center_px = {367.215, 248.375},
                 .distortion = Camera::Distortion::kRadialTangential,
                 .coefficients = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}};
  stereo.cam1 = {.width_px = 752,
                 .height_px = 480,
                 .focal_px = {457.587, 456.134},
                 .center_px = {379.999, 255.238},
                 .distortion = Camera::Distortion::kRadialTangential,
                 .coefficients = {-0.28368365, 0.07451284, -0.00010473, -3.555907e-05}};
  Eigen::Matrix<double, 3, 4> rows;
  rows << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,  //
      0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,          //
      -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949;
  stereo.T_body_cam0 = pose_from_rows(rows);
  rows << 0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556,  //
      0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024,        //
      -0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038;
  stereo.T_body_cam1 = pose_from_rows(rows);
  return stereo;
}

}  // namespace fleetloc
