#include "test/unit/tracking/textured_scene.hpp"

#include <opencv2/imgproc.hpp>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr double kTexelsPerMeter = 100.0;

cv::Mat smooth_noise(int size, std::uint64_t seed) {
  cv::Mat noise(size, size, CV_32F);
  cv::RNG(seed).fill(noise, cv::RNG::UNIFORM, 0.0, 255.0);
  cv::GaussianBlur(noise, noise, cv::Size(0, 0), 2.5);
  cv::normalize(noise, noise, 20.0, 235.0, cv::NORM_MINMAX);
  return noise;
}

Camera small_camera() {
  return {.width_px = 376,
          .height_px = 240,
          .focal_px = {230.0, 229.0},
          .center_px = {186.0, 122.0},
          .distortion = Camera::Distortion::kRadialTangential,
          .coefficients = {-0.25, 0.06, 2e-4, 1e-4}};
}

std::vector<Eigen::Vector3d> rays_of(const Camera& camera) {
  std::vector<Eigen::Vector3d> rays;
  for (int v = 0; v < camera.height_px; ++v) {
    for (int u = 0; u < camera.width_px; ++u) {
      rays.push_back(unproject(camera, Eigen::Vector2d(u, v)).value());
    }
  }
  return rays;
}

/// Texture coordinates of where a ray meets the plane z = depth.
cv::Vec2f texel(const Eigen::Vector3d& origin, const Eigen::Vector3d& ray, double depth) {
  const Eigen::Vector3d p = origin + ray * ((depth - origin.z()) / ray.z());
  return {static_cast<float>(p.x() * kTexelsPerMeter), static_cast<float>(p.y() * kTexelsPerMeter)};
}

cv::Mat sampled(const cv::Mat& texture, const cv::Mat& texels) {
  cv::Mat image;
  cv::remap(texture, image, texels, cv::noArray(), cv::INTER_CUBIC, cv::BORDER_WRAP);
  return image;
}

}  // namespace

TexturedScene::TexturedScene() : wall_(smooth_noise(1200, 3)), poster_(smooth_noise(400, 4)) {
  calibration_.cam0 = small_camera();
  calibration_.cam1 = small_camera();
  calibration_.cam1.center_px += Eigen::Vector2d(3.0, -2.0);
  calibration_.T_body_cam0.R = exp_so3({0.01, -0.02, 0.03});
  calibration_.T_body_cam0.p = {0.02, 0.01, 0.0};
  calibration_.T_body_cam1.R = exp_so3({0.0, -0.01, 0.02});
  calibration_.T_body_cam1.p = {0.13, 0.015, 0.002};
  stereo_ = rectified(calibration_);
  rays0_ = rays_of(calibration_.cam0);
  rays1_ = rays_of(calibration_.cam1);
}

StereoFrame TexturedScene::render(const Pose& T_world_body,
                                  const std::optional<Eigen::Vector2d>& poster) const {
  return {.stamp = Timestamp{},
          .left = render(rays0_, T_world_body * calibration_.T_body_cam0, poster),
          .right = render(rays1_, T_world_body * calibration_.T_body_cam1, poster)};
}

cv::Mat TexturedScene::render(const std::vector<Eigen::Vector3d>& rays,
                              const Pose& T_world_cam,
                              const std::optional<Eigen::Vector2d>& poster) const {
  const cv::Size size(calibration_.cam0.width_px, calibration_.cam0.height_px);
  const auto wall_middle = 0.5F * static_cast<float>(wall_.cols);
  const auto poster_middle = 0.5F * static_cast<float>(poster_.cols);
  const auto half = static_cast<float>(kPosterHalf_m * kTexelsPerMeter);
  cv::Mat on_wall(size, CV_32FC2);
  cv::Mat on_poster(size, CV_32FC2);
  cv::Mat is_poster(size, CV_8U, cv::Scalar(0));
  for (int i = 0; i < size.area(); ++i) {
    const Eigen::Vector3d ray = T_world_cam.R * rays[static_cast<std::size_t>(i)];
    const cv::Point at(i % size.width, i / size.width);
    on_wall.at<cv::Vec2f>(at) =
        texel(T_world_cam.p, ray, kWall_m) + cv::Vec2f(wall_middle, wall_middle);
    if (!poster) continue;
    const Eigen::Vector3d origin = T_world_cam.p - Eigen::Vector3d(poster->x(), poster->y(), 0.0);
    const cv::Vec2f from_center = texel(origin, ray, kPoster_m);
    on_poster.at<cv::Vec2f>(at) = from_center + cv::Vec2f(poster_middle, poster_middle);
    is_poster.at<unsigned char>(at) =
        std::abs(from_center[0]) < half && std::abs(from_center[1]) < half ? 255 : 0;
  }
  cv::Mat image = sampled(wall_, on_wall);
  if (poster) sampled(poster_, on_poster).copyTo(image, is_poster);
  image.convertTo(image, CV_8U);
  return image;
}

Eigen::Vector3d TexturedScene::wall_point(const Pose& T_world_body,
                                          const Eigen::Vector2d& rectified) const {
  const Pose T_world_cam = T_world_body * stereo_.T_body_cam0;
  const Eigen::Vector2d ideal = (rectified - stereo_.center_px) / stereo_.focal_px;
  const Eigen::Vector3d ray = T_world_cam.R * ideal.homogeneous();
  return T_world_cam.p + ray * ((kWall_m - T_world_cam.p.z()) / ray.z());
}

Eigen::Vector3d TexturedScene::project_point(const Pose& T_world_body,
                                             const Eigen::Vector3d& p_world) const {
  return project(stereo_, inverse(T_world_body * stereo_.T_body_cam0) * p_world);
}

}  // namespace fleetloc
