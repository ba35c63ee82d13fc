#include "shared/sensors/stereo_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "shared/concurrency/parallel_rows.hpp"
#include "shared/core/counter_random.hpp"
#include "shared/sensors/pixel_block.hpp"

namespace fleetloc {
namespace {

constexpr float kFarthest_m = 1000.0F;

constexpr auto kBlockOffsets = PixelBlock::lattice_first();
constexpr float kLeastContrast = 0.04F;  // that an edge must have to be smoothed

struct CameraFrame {
  explicit CameraFrame(const Pose& T_map_cam)
      : R_map_cam(T_map_cam.R.toRotationMatrix().cast<float>()), p_map(T_map_cam.p.cast<float>()) {}
  Eigen::Matrix3f R_map_cam;
  Eigen::Vector3f p_map;
};

/// What a pixel's ray sees of the sun.
std::uint8_t sun_part(int u, int v) {
  return static_cast<std::uint8_t>((u + v) % kSunParts);
}

int rows_of_blocks(int height_px) {
  return (height_px + PixelBlock::kHeight - 1) / PixelBlock::kHeight;
}

/// Calls `act(u, v, i)` for the pixels of the block at (first_u, first_v) that lie in the image.
template <typename Act>
void for_each_pixel(const ViewRays& rays, int first_u, int first_v, const Act& act) {
  for (std::size_t i = 0; i < kBlockOffsets.size(); ++i) {
    const int u = first_u + kBlockOffsets[i].u;
    const int v = first_v + kBlockOffsets[i].v;
    if (u < rays.width_px() && v < rays.height_px()) act(u, v, i);
  }
}

void set_lane(CameraPacket& packet,
              std::size_t lane,
              const Eigen::Vector3f& direction_cam,
              std::uint8_t part) {
  packet.direction_x[lane] = direction_cam.x();
  packet.direction_y[lane] = direction_cam.y();
  packet.direction_z[lane] = direction_cam.z();
  packet.sun_part[lane] = part;
}

/// By rows of blocks; lanes beyond the image stay zero.
std::vector<std::array<CameraPacket, PixelBlock::kPackets>> blocks_of(const ViewRays& rays) {
  std::vector<std::array<CameraPacket, PixelBlock::kPackets>> blocks;
  for (int v = 0; v < rays.height_px(); v += PixelBlock::kHeight) {
    for (int u = 0; u < rays.width_px(); u += PixelBlock::kWidth) {
      auto& block = blocks.emplace_back();
      for_each_pixel(rays, u, v, [&](int pixel_u, int pixel_v, std::size_t i) {
        set_lane(block.at(i / RayPacket::kSize),
                 i % RayPacket::kSize,
                 rays.direction(pixel_u, pixel_v),
                 sun_part(pixel_u, pixel_v));
      });
    }
  }
  return blocks;
}

ViewPacket in_map(const CameraPacket& packet, const CameraFrame& frame, float pixel_rad) {
  ViewPacket view{};
  view.sun_part = packet.sun_part;
  view.pixel_rad = pixel_rad;
  view.rays.origin_x.fill(frame.p_map.x());
  view.rays.origin_y.fill(frame.p_map.y());
  view.rays.origin_z.fill(frame.p_map.z());
  const Eigen::Matrix3f& R = frame.R_map_cam;
  for (std::size_t i = 0; i < RayPacket::kSize; ++i) {
    const float x = packet.direction_x[i];
    const float y = packet.direction_y[i];
    const float z = packet.direction_z[i];
    view.rays.direction_x[i] = R(0, 0) * x + R(0, 1) * y + R(0, 2) * z;
    view.rays.direction_y[i] = R(1, 0) * x + R(1, 1) * y + R(1, 2) * z;
    view.rays.direction_z[i] = R(2, 0) * x + R(2, 1) * y + R(2, 2) * z;
    view.rays.most_m[i] = x * x + y * y + z * z > 0.0F ? kFarthest_m : -1.0F;
  }
  return view;
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
      eyes_{Eye(calibration.cam0,
                calibration.T_body_cam0,
                PixelResponse(config.noise, CounterRandom(seed, 0))),
            Eye(calibration.cam1,
                calibration.T_body_cam1,
                PixelResponse(config.noise, CounterRandom(seed, 1)))} {}

StereoRenderer::Eye::Eye(const Camera& camera, Pose T_body_camera, const PixelResponse& noise)
    : rays(camera),
      blocks(blocks_of(rays)),
      T_body_cam(std::move(T_body_camera)),
      response(noise) {}

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
    add_sun(eye);
    if (config_.smooth_edges && config_.motion_samples == 1) smooth_edges(eye, view, T_map_cam);
    if (config_.motion_samples == 1) return;
    if (sum.empty()) sum.resize(eye.radiance.size());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += eye.radiance[k];
  }
  for (float& value : sum) value /= static_cast<float>(config_.motion_samples);
  eye.radiance = std::move(sum);
}

void StereoRenderer::trace(Eye& eye, const SceneView& view, const Pose& T_map_cam) {
  const int width = eye.rays.width_px();
  const int height = eye.rays.height_px();
  const CameraFrame frame(T_map_cam);
  const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  eye.radiance.resize(pixels);
  eye.sun.resize(pixels);
  eye.keys.resize(pixels);
  eye.sunlit.resize(pixels);
  const int rows = rows_of_blocks(height);
  const std::size_t blocks_per_row = eye.blocks.size() / static_cast<std::size_t>(rows);
  for_each_row(rows, config_.threads, [&](int row) {
    const auto* block = &eye.blocks[static_cast<std::size_t>(row) * blocks_per_row];
    for (int first_u = 0; first_u < width; first_u += PixelBlock::kWidth) {
      PixelBlock::Packets packets;
      for (std::size_t i = 0; i < packets.size(); ++i) {
        packets[i] = in_map((*block)[i], frame, eye.rays.pixel_rad());
      }
      const PixelBlock::Seen seen = see_block(view, light_, packets);
      const int first_v = row * PixelBlock::kHeight;
      for_each_pixel(eye.rays, first_u, first_v, [&](int u, int v, std::size_t i) {
        const std::size_t packet = i / RayPacket::kSize;
        const std::size_t lane = i % RayPacket::kSize;
        const std::size_t pixel = eye.rays.index(u, v);
        eye.radiance[pixel] = seen.packets[packet].radiance[lane];
        eye.sun[pixel] = seen.packets[packet].sun[lane];
        eye.keys[pixel] = seen.packets[packet].key[lane];
        eye.sunlit[pixel] = (seen.sunlit[packet] >> lane) & 1U;
      });
      ++block;
    }
  });
}

void StereoRenderer::add_sun(Eye& eye) const {
  const auto width = static_cast<std::size_t>(eye.rays.width_px());
  for_each_row(eye.rays.height_px(), config_.threads, [&](int v) {
    const std::vector<int> lit = sunlit_of_three(eye, v);
    for (std::size_t u = 0; u < width; ++u) {
      const int sum = lit[u > 0 ? u - 1 : u] + lit[u] + lit[std::min(u + 1, width - 1)];
      if (sum == 0) continue;
      const int column = static_cast<int>(u);
      const float share = sum == 9 ? 1.0F : sunlit_share(eye, column, v);
      const std::size_t pixel = eye.rays.index(column, v);
      eye.radiance[pixel] += share * eye.sun[pixel];
    }
  });
}

std::vector<int> StereoRenderer::sunlit_of_three(const Eye& eye, int v) {
  std::vector<int> sum(static_cast<std::size_t>(eye.rays.width_px()));
  for (const int near : {v - 1, v, v + 1}) {
    const int row = std::clamp(near, 0, eye.rays.height_px() - 1);
    const std::uint8_t* sunlit = &eye.sunlit[eye.rays.index(0, row)];
    for (std::size_t u = 0; u < sum.size(); ++u) sum[u] += sunlit[u];
  }
  return sum;
}

float StereoRenderer::sunlit_share(const Eye& eye, int u, int v) {
  const std::uint32_t surface = eye.keys[eye.rays.index(u, v)] >> 16U;
  int lit = 0;
  int count = 0;
  for (int y = std::max(v - 1, 0); y <= std::min(v + 1, eye.rays.height_px() - 1); ++y) {
    for (int x = std::max(u - 1, 0); x <= std::min(u + 1, eye.rays.width_px() - 1); ++x) {
      const std::size_t pixel = eye.rays.index(x, y);
      if (eye.keys[pixel] >> 16U != surface) continue;
      lit += eye.sunlit[pixel];
      ++count;
    }
  }
  return static_cast<float>(lit) / static_cast<float>(count);
}

void StereoRenderer::smooth_edges(Eye& eye, const SceneView& view, const Pose& T_map_cam) {
  const int rows = rows_of_blocks(eye.rays.height_px());
  std::vector<std::vector<Edge>> edges(static_cast<std::size_t>(rows));
  for_each_row(rows, config_.threads, [&](int row) {
    std::vector<Edge>& found = edges[static_cast<std::size_t>(row)];
    found = edges_in(eye, row);
    look_at(found, eye, view, T_map_cam);
  });
  // A pixel is the mean over its square, by the trapezoidal rule along both of its axes.
  std::vector<float> smoothed = eye.radiance;
  for (const std::vector<Edge>& in_row : edges) {
    for (const Edge& edge : in_row) {
      for (const std::size_t pixel : {edge.pixel, edge.next}) {
        smoothed[pixel] += 0.25F * (edge.radiance - eye.radiance[pixel]);
      }
    }
  }
  eye.radiance = std::move(smoothed);
}

void StereoRenderer::look_at(std::vector<Edge>& found,
                             const Eye& eye,
                             const SceneView& view,
                             const Pose& T_map_cam) const {
  const CameraFrame frame(T_map_cam);
  for (std::size_t first = 0; first < found.size(); first += RayPacket::kSize) {
    CameraPacket between{};
    const std::size_t count = std::min<std::size_t>(RayPacket::kSize, found.size() - first);
    for (std::size_t i = 0; i < count; ++i) {
      const Edge& edge = found[first + i];
      const Eigen::Vector3f direction = eye.rays.direction_between(edge.pixel, edge.next);
      set_lane(between, i, direction, edge.sun_part);
    }
    const ViewPacket packet = in_map(between, frame, eye.rays.pixel_rad());
    const HitPacket hits = view.caster.first_hits(packet.rays);
    const SeenPacket seen = see(view, light_, packet, hits);
    const std::uint32_t lit = sunlit(view, light_, packet, hits);
    for (std::size_t i = 0; i < count; ++i) {
      const float sun = ((lit >> i) & 1U) != 0U ? seen.sun[i] : 0.0F;
      found[first + i].radiance = seen.radiance[i] + sun;
    }
  }
}

bool StereoRenderer::differs(const Eye& eye, std::size_t pixel, std::size_t next) {
  if (eye.keys[pixel] == eye.keys[next]) return false;
  if (eye.keys[pixel] == 0U || eye.keys[next] == 0U) return false;
  const float contrast = std::abs(eye.radiance[pixel] - eye.radiance[next]);
  return contrast >= kLeastContrast * (eye.radiance[pixel] + eye.radiance[next]);
}

std::vector<StereoRenderer::Edge> StereoRenderer::edges_in(const Eye& eye, int row) {
  const int width = eye.rays.width_px();
  const int height = eye.rays.height_px();
  const int first_v = row * PixelBlock::kHeight;
  std::vector<Edge> edges;
  for (int first_u = 0; first_u < width; first_u += PixelBlock::kWidth) {
    for_each_pixel(eye.rays, first_u, first_v, [&](int u, int v, std::size_t) {
      const std::size_t pixel = eye.rays.index(u, v);
      const auto look = [&](std::size_t next) {
        if (!differs(eye, pixel, next)) return;
        edges.push_back(
            {.pixel = pixel, .next = next, .radiance = 0.0F, .sun_part = sun_part(u, v + 2)});
      };
      if (u + 1 < width) look(pixel + 1);
      if (v + 1 < height) look(pixel + static_cast<std::size_t>(width));
    });
  }
  return edges;
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
