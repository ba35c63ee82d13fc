#include "shared/factors/reprojection_factor.hpp"

#include <cassert>

namespace fleetloc {
namespace {

// A point nearer than this in front of the camera, or behind it, cannot be projected. It gets the
// residual of kBehind pixels and no gradient: the optimizer turns back, and outlier tests find it.
constexpr double kMinDepth = 0.01;  // [m]
constexpr double kBehind = 500.0;   // [px]

struct CameraPoint {
  Eigen::Matrix3d R_world_body;
  Eigen::Vector3d p_body;
  Eigen::Vector3d p_cam0;
};

CameraPoint camera_point(const double* pose, const double* point, const CameraMounting& camera) {
  const Pose T_world_body = pose_from(pose);
  const Eigen::Map<const Eigen::Vector3d> p_world(point);
  CameraPoint seen;
  seen.R_world_body = T_world_body.R.toRotationMatrix();
  seen.p_body.noalias() = seen.R_world_body.transpose() * (p_world - T_world_body.p);
  seen.p_cam0 = camera.p_cam0;
  seen.p_cam0.noalias() += camera.R_cam0_body * seen.p_body;
  return seen;
}

// Rows: u_left, v, u_right, by p_cam0.
template <int Rows>
Eigen::Matrix<double, Rows, 3> projection_jacobian(const RectifiedStereo& stereo,
                                                   const Eigen::Vector3d& p_cam0) {
  const double inverse_z = 1.0 / p_cam0.z();
  const double scale = stereo.focal_px * inverse_z;
  Eigen::Matrix<double, Rows, 3> J;
  J.row(0) << scale, 0.0, -scale * inverse_z * p_cam0.x();
  J.row(1) << 0.0, scale, -scale * inverse_z * p_cam0.y();
  if constexpr (Rows == 3) {
    J.row(2) << scale, 0.0, -scale * inverse_z * (p_cam0.x() - stereo.baseline_m);
  }
  return J;
}

template <int Rows>
void set_jacobians_zero(double** jacobians) {
  if (jacobians[0] != nullptr) {
    RowMajorMap<Rows, 7>(jacobians[0]).setZero();
  }
  if (jacobians[1] != nullptr) {
    RowMajorMap<Rows, 3>(jacobians[1]).setZero();
  }
}

// p_cam0 = R_cam0_body R_body_world (p_world - p_body): by the tangent of the pose
// [hat(p_body), -I] in body, by the point R_body_world.
template <int Rows>
void write_jacobians(const Eigen::Matrix<double, Rows, 3>& J_body,
                     const CameraPoint& point,
                     double** jacobians) {
  if (jacobians[0] != nullptr) {
    RowMajorMap<Rows, 7> J_pose(jacobians[0]);
    for (int row = 0; row < Rows; ++row) {
      // a^T hat(b) = (a x b)^T
      const Eigen::Vector3d gradient = J_body.row(row).transpose();
      J_pose.row(row).template head<3>() = gradient.cross(point.p_body).transpose();
    }
    J_pose.template middleCols<3>(3) = -J_body;
    J_pose.col(6).setZero();
  }
  if (jacobians[1] != nullptr) {
    RowMajorMap<Rows, 3>(jacobians[1]).noalias() = J_body * point.R_world_body.transpose();
  }
}

// What both factors know besides the measurement.
struct Setup {
  const RectifiedStereo& stereo;
  const CameraMounting& camera;
  double inverse_sigma;
  const PoseParameters* first_estimate;
};

// What both factors do; `measured` is the first Rows of (u_left, v, u_right).
template <int Rows>
void evaluate(const Eigen::Matrix<double, Rows, 1>& measured,
              const Setup& setup,
              const double* const* parameters,
              Eigen::Map<Eigen::Matrix<double, Rows, 1>> residual,
              double** jacobians) {
  CameraPoint point = camera_point(parameters[0], parameters[1], setup.camera);
  if (point.p_cam0.z() < kMinDepth) {
    residual.setConstant(kBehind * setup.inverse_sigma);
    if (jacobians != nullptr) {
      set_jacobians_zero<Rows>(jacobians);
    }
    return;
  }
  residual =
      setup.inverse_sigma * (project(setup.stereo, point.p_cam0).template head<Rows>() - measured);
  if (jacobians == nullptr) {
    return;
  }
  if (setup.first_estimate != nullptr) {
    point = camera_point(setup.first_estimate->data(), parameters[1], setup.camera);
    if (point.p_cam0.z() < kMinDepth) {
      set_jacobians_zero<Rows>(jacobians);
      return;
    }
  }
  const Eigen::Matrix<double, Rows, 3> J_body =
      setup.inverse_sigma * projection_jacobian<Rows>(setup.stereo, point.p_cam0) *
      setup.camera.R_cam0_body;
  write_jacobians<Rows>(J_body, point, jacobians);
}

}  // namespace

CameraMounting::CameraMounting(const Pose& T_body_cam0)
    : R_cam0_body(T_body_cam0.R.toRotationMatrix().transpose()),
      p_cam0(-R_cam0_body * T_body_cam0.p) {}

StereoReprojectionFactor::StereoReprojectionFactor(const StereoObservation& observation,
                                                   const RectifiedStereo& stereo,
                                                   StereoNoise noise,
                                                   const PoseParameters* first_estimate)
    : measured_(
          observation.left.x(), observation.left.y(), observation.left.x() - observation.disparity),
      stereo_(stereo),
      camera_(stereo.T_body_cam0),
      inverse_sigma_(1.0 / noise.pixel_sigma),
      first_estimate_(first_estimate) {
  assert(observation.disparity > 0.0);
}

bool StereoReprojectionFactor::Evaluate(const double* const* parameters,
                                        double* residuals,
                                        double** jacobians) const {
  evaluate<3>(measured_,
              {stereo_, camera_, inverse_sigma_, first_estimate_},
              parameters,
              Eigen::Map<Eigen::Vector3d>(residuals),
              jacobians);
  return true;
}

MonoReprojectionFactor::MonoReprojectionFactor(const StereoObservation& observation,
                                               const RectifiedStereo& stereo,
                                               StereoNoise noise,
                                               const PoseParameters* first_estimate)
    : measured_(observation.left),
      stereo_(stereo),
      camera_(stereo.T_body_cam0),
      inverse_sigma_(1.0 / noise.pixel_sigma),
      first_estimate_(first_estimate) {}

bool MonoReprojectionFactor::Evaluate(const double* const* parameters,
                                      double* residuals,
                                      double** jacobians) const {
  evaluate<2>(measured_,
              {stereo_, camera_, inverse_sigma_, first_estimate_},
              parameters,
              Eigen::Map<Eigen::Vector2d>(residuals),
              jacobians);
  return true;
}

}  // namespace fleetloc
