#include "shared/sensors/stereo_renderer.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>

#include "shared/core/counter_random.hpp"
#include "shared/concurrency/parallel_rows.hpp"

namespace fleetloc {
namespace {

constexpr float kFarthest_m = 1000.0F;

/// Beside the pixel's middle [px]: with it, spread over the pixel.
const std::array<Eigen::Vector2f, kSunParts - 1> kEdgeOffsets = {
    {{-0.33F, -0.25F}, {0.33F, 0.25F}}};

struct CameraFrame {
  explicit CameraFrame(const Pose& T_map_cam)
      : R_map_cam(T_map_cam.R.toRotationMatrix().cast<float>()), p_map(T_map_cam.p.cast<float>()) {}
  Eigen::Matrix3f R_map_cam;
  Eigen::Vector3f p_map;
};

ViewPacket empty_packet(const ViewRays& rays) {
  ViewPacket packet{};
  packet.rays.most_m.fill(-1.0F);
  packet.pixel_rad = rays.pixel_rad();
  return packet;
}

/// What a pixel's first ray sees of the sun.
int first_sun_part(int u, int v) {
  return (u + v) % kSunParts;
}

/// A direction of zero leaves the lane unused.
void set_ray(RayPacket& rays,
             std::size_t lane,
             const CameraFrame& frame,
             const Eigen::Vector3f& direction_cam) {
  const Eigen::Vector3f direction = frame.R_map_cam * direction_cam;
  rays.origin_x[lane] = frame.p_map.x();
  rays.origin_y[lane] = frame.p_map.y();
  rays.origin_z[lane] = frame.p_map.z();
  rays.direction_x[lane] = direction.x();
  rays.direction_y[lane] = direction.y();
  rays.direction_z[lane] = direction.z();
  rays.most_m[lane] = direction_cam.isZero() ? -1.0F : kFarthest_m;
}

/// Pixels of a row that differ from one of their neighbours.
std::vector<int> edge_pixels(const std::vector<std::uint32_t>& keys,
                             int row,
                             int width,
                             int height) {
  std::vector<int> found;
  const auto at = [&](int u, int v) {
    const int index = std::clamp(v, 0, height - 1) * width + std::clamp(u, 0, width - 1);
    return keys[static_cast<std::size_t>(index)];
  };
  for (int u = 0; u < width; ++u) {
    const std::uint32_t own = at(u, row);
    const bool is_edge = own != at(u - 1, row) || own != at(u + 1, row) || own != at(u, row - 1) ||
                         own != at(u, row + 1);
    if (is_edge) found.push_back(u);
  }
  return found;
}

}  // namespace

StereoRenderer::StereoRenderer(const StereoCalibration& calibration,
                               const SessionScene& scene,
                               const Config& config,
                               std::uint64_t seed)
    : config_(config),
      scene_(&scene),
      light_(light_of(scene)),
      exposure_(config.exposure),
      eyes_{{{.rays = ViewRays(calibration.cam0),
              .T_body_cam = calibration.T_body_cam0,
              .response = PixelResponse(config.noise, CounterRandom(seed, 0)),
              .radiance = {},
              .smoothed = {},
              .keys = {}},
             {.rays = ViewRays(calibration.cam1),
              .T_body_cam = calibration.T_body_cam1,
              .response = PixelResponse(config.noise, CounterRandom(seed, 1)),
              .radiance = {},
              .smoothed = {},
              .keys = {}}}} {}

StereoFrame StereoRenderer::render(const Shot& shot, const Motion& T_map_body) {
  for (Eye& eye : eyes_) expose(eye, shot, T_map_body);
  const std::vector<float>& metered = eyes_[0].radiance;
  double sum = 0.0;
  for (const float radiance : metered) sum += static_cast<double>(radiance);
  const auto mean = static_cast<float>(sum / static_cast<double>(metered.size()));
  const float gain = exposure_.next(shot.time_s, mean);
  return {.stamp = shot.stamp,
          .left = developed(eyes_[0], shot.frame, gain),
          .right = developed(eyes_[1], shot.frame, gain)};
}

void StereoRenderer::expose(Eye& eye, const Shot& shot, const Motion& T_map_body) {
  std::vector<float> sum;
  for (int i = 0; i < config_.motion_samples; ++i) {
    const double share = (i + 0.5) / config_.motion_samples - 0.5;
    const double time_s = shot.time_s + share * static_cast<double>(config_.exposure_time_s);
    const SceneView view = scene_->at(time_s);
    const Pose T_map_cam = T_map_body(time_s) * eye.T_body_cam;
    trace(eye, view, T_map_cam);
    if (config_.smooth_edges && config_.motion_samples == 1) trace_edges(eye, view, T_map_cam);
    if (config_.motion_samples == 1) return;
    if (sum.empty()) sum.resize(eye.radiance.size());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += eye.radiance[k];
  }
  for (float& value : sum) value /= static_cast<float>(config_.motion_samples);
  eye.radiance = std::move(sum);
}

void StereoRenderer::trace(Eye& eye, const SceneView& view, const Pose& T_map_cam) {
  const int width = eye.rays.width_px();
  const CameraFrame frame(T_map_cam);
  const auto pixels =
      static_cast<std::size_t>(width) * static_cast<std::size_t>(eye.rays.height_px());
  eye.radiance.assign(pixels, 0.0F);
  eye.keys.assign(pixels, 0U);
  for_each_row(eye.rays.height_px(), config_.threads, [&](int row) {
    for (int first = 0; first < width; first += RayPacket::kSize) {
      ViewPacket packet = empty_packet(eye.rays);
      const int count = std::min(RayPacket::kSize, width - first);
      for (int i = 0; i < count; ++i) {
        const auto lane = static_cast<std::size_t>(i);
        set_ray(packet.rays, lane, frame, eye.rays.direction(first + i, row));
        packet.sun_part[lane] = static_cast<std::uint8_t>(first_sun_part(first + i, row));
      }
      const SeenPacket seen = see(view, light_, packet);
      const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(first);
      std::copy_n(seen.radiance.begin(), count, &eye.radiance[at]);
      std::copy_n(seen.key.begin(), count, &eye.keys[at]);
    }
  });
}

void StereoRenderer::trace_edges(Eye& eye, const SceneView& view, const Pose& T_map_cam) {
  const int width = eye.rays.width_px();
  const int height = eye.rays.height_px();
  const CameraFrame frame(T_map_cam);
  eye.smoothed = eye.radiance;
  for_each_row(height, config_.threads, [&](int row) {
    const std::vector<int> edges = edge_pixels(eye.keys, row, width, height);
    const std::size_t rays_per_row = edges.size() * kEdgeOffsets.size();
    float* const to =
        &eye.smoothed[static_cast<std::size_t>(row) * static_cast<std::size_t>(width)];
    for (std::size_t first = 0; first < rays_per_row; first += RayPacket::kSize) {
      ViewPacket packet = empty_packet(eye.rays);
      const std::size_t count = std::min<std::size_t>(RayPacket::kSize, rays_per_row - first);
      const auto pixel = [&](std::size_t ray) { return edges[ray / kEdgeOffsets.size()]; };
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t sample = (first + i) % kEdgeOffsets.size();
        const int u = pixel(first + i);
        set_ray(packet.rays, i, frame, eye.rays.direction_near(u, row, kEdgeOffsets.at(sample)));
        const int part = first_sun_part(u, row) + 1 + static_cast<int>(sample);
        packet.sun_part[i] = static_cast<std::uint8_t>(part % kSunParts);
      }
      const SeenPacket seen = see(view, light_, packet);
      for (std::size_t i = 0; i < count; ++i) to[pixel(first + i)] += seen.radiance[i];
    }
    for (const int u : edges) to[u] /= static_cast<float>(kEdgeOffsets.size() + 1);
  });
  std::swap(eye.radiance, eye.smoothed);
}

cv::Mat StereoRenderer::developed(const Eye& eye, std::uint64_t frame, float gain) const {
  const int width = eye.rays.width_px();
  cv::Mat image(eye.rays.height_px(), width, CV_8UC1);
  const auto columns = static_cast<std::size_t>(width);
  const std::uint64_t stride = (columns + 3) / 4 * 4;
  for_each_row(eye.rays.height_px(), config_.threads, [&](int row) {
    const auto index = static_cast<std::size_t>(row);
    std::vector<float> radiance(columns);
    for (int u = 0; u < width; ++u) {
      radiance[static_cast<std::size_t>(u)] =
          eye.radiance[index * columns + static_cast<std::size_t>(u)] *
          eye.rays.vignetting(u, row, config_.corner_loss);
    }
    eye.response.respond(radiance,
                         {.frame = frame, .first_pixel = index * stride, .gain = gain},
                         std::span<std::uint8_t>(image.ptr<std::uint8_t>(row), columns));
  });
  return image;
}

StereoRenderer::Config read_stereo_renderer_config(ConfigReader section) {
  const auto number = [](ConfigReader& reader, const char* key, double least, double most) {
    return static_cast<float>(reader.number(key, least, most));
  };
  StereoRenderer::Config config{};
  config.threads = section.integer("threads", 1, 64);
  ConfigReader exposure = section.section("exposure");
  config.exposure = {.target_gray = number(exposure, "target_gray", 10.0, 240.0),
                     .lag_s = number(exposure, "lag_s", 0.0, 60.0),
                     .least_gain = number(exposure, "least_gain", 0.01, 1e6),
                     .most_gain = number(exposure, "most_gain", 0.01, 1e6)};
  ConfigReader noise = section.section("noise");
  config.noise = {.read_gray = number(noise, "read_gray", 0.0, 50.0),
                  .shot_gray = number(noise, "shot_gray", 0.0, 10.0),
                  .reference_gain = number(noise, "reference_gain", 0.01, 1e6)};
  config.corner_loss = number(section, "corner_loss", 0.0, 0.9);
  ConfigReader blur = section.section("motion_blur");
  config.exposure_time_s = number(blur, "exposure_time_s", 0.0, 0.1);
  config.motion_samples = blur.integer("samples", 1, 64);
  config.smooth_edges = section.get<bool>("smooth_edges");
  return config;
}

}  // namespace fleetloc
