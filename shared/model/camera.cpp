#include "shared/model/camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "shared/geometry/angle.hpp"

namespace fleetloc {
namespace {

constexpr int kMaxIterations = 20;
constexpr double kTolerance = 1e-12;                // of normalized image coordinates
constexpr double kUsableAngle = 75.0 * kRadPerDeg;  // of a rectified view, off axis

/// Coefficients of r * (1 + c0 r^2 + c1 r^4 + c2 r^6 + c3 r^8), which both models share: r is the
/// tangent of the angle to the axis (radial-tangential) or the angle itself (equidistant).
Eigen::Vector4d radial_coefficients(const Camera& camera) {
  const Eigen::Vector4d& c = camera.coefficients;
  if (camera.distortion == Camera::Distortion::kEquidistant) return c;
  return {c[0], c[1], 0.0, 0.0};
}

double radial_factor(const Eigen::Vector4d& c, double s) {
  return 1.0 + s * (c[0] + s * (c[1] + s * (c[2] + s * c[3])));
}

/// Derivative of r * radial_factor(c, r^2) by r.
double radial_slope(const Eigen::Vector4d& c, double s) {
  return 1.0 + s * (3.0 * c[0] + s * (5.0 * c[1] + s * (7.0 * c[2] + s * 9.0 * c[3])));
}

/// False where the distortion has folded back before radius r, so that pixels are ambiguous.
bool increases_up_to(const Eigen::Vector4d& c, double r) {
  constexpr int kSteps = 16;
  for (int i = 1; i <= kSteps; ++i) {
    if (radial_slope(c, r * r * i / kSteps) <= 0.0) return false;
  }
  return true;
}

/// Brown's model: ideal to distorted normalized coordinates.
Eigen::Vector2d distort_radial_tangential(const Camera& camera, const Eigen::Vector2d& ideal) {
  const double x = ideal.x();
  const double y = ideal.y();
  const double s = ideal.squaredNorm();
  const double p1 = camera.coefficients[2];
  const double p2 = camera.coefficients[3];
  return ideal * radial_factor(radial_coefficients(camera), s) +
         Eigen::Vector2d(2.0 * p1 * x * y + p2 * (s + 2.0 * x * x),
                         p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y);
}

/// Of distort_radial_tangential by `ideal`.
Eigen::Matrix2d distortion_jacobian(const Camera& camera, const Eigen::Vector2d& ideal) {
  const double x = ideal.x();
  const double y = ideal.y();
  const double s = ideal.squaredNorm();
  const double k1 = camera.coefficients[0];
  const double k2 = camera.coefficients[1];
  const double p1 = camera.coefficients[2];
  const double p2 = camera.coefficients[3];
  const double factor = 1.0 + s * (k1 + s * k2);
  const double slope = 2.0 * (k1 + 2.0 * k2 * s);  // of factor, by s, twice
  Eigen::Matrix2d J;
  J << factor + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x,
      slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y, slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y,
      factor + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  return J;
}

/// Kannala and Brandt: A generic camera model, 2006, with the odd polynomial of the angle.
Eigen::Vector2d distort_equidistant(const Camera& camera, const Eigen::Vector2d& ideal) {
  const double tangent = ideal.norm();
  const double angle = std::atan(tangent);
  const double scale = tangent > 1e-9 ? angle / tangent : 1.0;
  return ideal * scale * radial_factor(camera.coefficients, angle * angle);
}

std::optional<Eigen::Vector2d> undistort_radial_tangential(const Camera& camera,
                                                           const Eigen::Vector2d& distorted) {
  Eigen::Vector2d ideal = distorted;
  for (int i = 0; i < kMaxIterations; ++i) {
    const Eigen::Vector2d error = distort_radial_tangential(camera, ideal) - distorted;
    if (!error.allFinite()) return std::nullopt;
    const Eigen::Matrix2d J = distortion_jacobian(camera, ideal);
    const double determinant = J.determinant();
    if (determinant <= 0.0) return std::nullopt;
    if (error.norm() < kTolerance) {
      if (!increases_up_to(radial_coefficients(camera), ideal.norm())) return std::nullopt;
      return ideal;
    }
    ideal -= J.inverse() * error;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> undistort_equidistant(const Camera& camera,
                                                     const Eigen::Vector2d& distorted) {
  const Eigen::Vector4d& c = camera.coefficients;
  const double radius = distorted.norm();
  if (radius < 1e-9) return distorted;
  double angle = std::min(radius, 1.5);
  for (int i = 0; i < kMaxIterations; ++i) {
    const double error = angle * radial_factor(c, angle * angle) - radius;
    const double slope = radial_slope(c, angle * angle);
    if (!std::isfinite(error) || slope <= 0.0) return std::nullopt;
    if (std::abs(error) < kTolerance) {
      const bool in_front = angle > 0.0 && angle < 0.5 * std::numbers::pi;
      if (!in_front || !increases_up_to(c, angle)) return std::nullopt;
      return distorted * (std::tan(angle) / radius);
    }
    angle -= error / slope;
  }
  return std::nullopt;
}

/// The largest |x| or |y| of directions to the image's border in the rectified frame, z = 1.
double extent(const Camera& camera, const Eigen::Matrix3d& R_rectified_cam) {
  constexpr int kSteps = 32;
  double largest = 0.0;
  const auto include = [&](double u, double v) {
    const auto direction = unproject(camera, {u, v});
    if (!direction) return;
    const Eigen::Vector3d rotated = R_rectified_cam * *direction;
    const double limit = std::tan(kUsableAngle) * rotated.z();
    if (rotated.z() <= 0.0 || rotated.head<2>().norm() > limit) return;
    largest = std::max(largest, rotated.head<2>().cwiseAbs().maxCoeff() / rotated.z());
  };
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      include(camera.width_px * double(i) / kSteps, camera.height_px * double(k) / kSteps);
    }
  }
  return largest;
}

}  // namespace

std::optional<Eigen::Vector2d> project(const Camera& camera, const Eigen::Vector3d& p_cam) {
  if (!(p_cam.z() > 0.0)) return std::nullopt;
  const Eigen::Vector2d ideal = p_cam.head<2>() / p_cam.z();
  const bool equidistant = camera.distortion == Camera::Distortion::kEquidistant;
  const double radius = equidistant ? std::atan(ideal.norm()) : ideal.norm();
  if (!increases_up_to(radial_coefficients(camera), radius)) return std::nullopt;
  const Eigen::Vector2d distorted =
      equidistant ? distort_equidistant(camera, ideal) : distort_radial_tangential(camera, ideal);
  return camera.focal_px.cwiseProduct(distorted) + camera.center_px;
}

std::optional<Eigen::Vector3d> unproject(const Camera& camera, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d distorted = (pixel - camera.center_px).cwiseQuotient(camera.focal_px);
  const auto ideal = camera.distortion == Camera::Distortion::kEquidistant
                         ? undistort_equidistant(camera, distorted)
                         : undistort_radial_tangential(camera, distorted);
  if (!ideal) return std::nullopt;
  return ideal->homogeneous();
}

RectifiedStereo rectified(const StereoCalibration& calibration) {
  const Pose T_cam0_cam1 = inverse(calibration.T_body_cam0) * calibration.T_body_cam1;
  const double baseline = T_cam0_cam1.p.norm();
  const Eigen::Vector3d forward =
      Eigen::Vector3d::UnitZ() + T_cam0_cam1.R * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d x = T_cam0_cam1.p / baseline;
  const Eigen::Vector3d z = forward - x * x.dot(forward);
  if (!(baseline > 1e-6) || z.norm() < 0.5) {
    throw std::invalid_argument("stereo calibration: the cameras must stand side by side");
  }
  Eigen::Matrix3d R_cam0_rectified;
  R_cam0_rectified << x, z.normalized().cross(x), z.normalized();
  const Eigen::Matrix3d R_rectified_cam0 = R_cam0_rectified.transpose();
  const double widest =
      std::max(extent(calibration.cam0, R_rectified_cam0),
               extent(calibration.cam1, R_rectified_cam0 * T_cam0_cam1.R.toRotationMatrix()));
  const double fitting = (0.5 * kRectifiedSize - 1.0) / std::max(widest, 1e-3);
  RectifiedStereo stereo;
  stereo.focal_px = std::min(calibration.cam0.focal_px.mean(), fitting);
  stereo.center_px = Eigen::Vector2d::Constant(0.5 * kRectifiedSize);
  stereo.baseline_m = baseline;
  stereo.T_body_cam0 = calibration.T_body_cam0;
  stereo.T_body_cam0.R =
      (calibration.T_body_cam0.R * Eigen::Quaterniond(R_cam0_rectified)).normalized();
  return stereo;
}

Eigen::Vector3d project(const RectifiedStereo& stereo, const Eigen::Vector3d& p_cam0) {
  const double scale = stereo.focal_px / p_cam0.z();
  const double u = stereo.center_px.x() + scale * p_cam0.x();
  return {u, stereo.center_px.y() + scale * p_cam0.y(), u - scale * stereo.baseline_m};
}

}  // namespace fleetloc
