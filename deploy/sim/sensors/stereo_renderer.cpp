#include "deploy/sim/sensors/stereo_renderer.hpp"

#include <cstddef>
#include <span>
#include <utility>

#include "deploy/sim/sensors/smooth_edges.hpp"
#include "shared/concurrency/parallel_rows.hpp"
#include "shared/core/counter_random.hpp"

namespace fleetloc {
namespace {

constexpr auto kBlockOffsets = PixelBlock::lattice_first();

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

/// By rows of blocks; lanes beyond the image stay zero.
std::vector<std::array<CameraPacket, PixelBlock::kPackets>> blocks_of(const ViewRays& rays) {
  std::vector<std::array<CameraPacket, PixelBlock::kPackets>> blocks;
  for (int v = 0; v < rays.height_px(); v += PixelBlock::kHeight) {
    for (int u = 0; u < rays.width_px(); u += PixelBlock::kWidth) {
      auto& block = blocks.emplace_back();
      for_each_pixel(rays, u, v, [&](int pixel_u, int pixel_v, std::size_t i) {
        block.at(i / RayPacket::kSize)
            .set(i % RayPacket::kSize,
                 rays.direction(pixel_u, pixel_v),
                 sun_sample(pixel_u, pixel_v));
      });
    }
  }
  return blocks;
}

std::vector<float> vignetting_of(const ViewRays& rays, float corner_loss) {
  std::vector<float> shares;
  for (int v = 0; v < rays.height_px(); ++v) {
    for (int u = 0; u < rays.width_px(); ++u) shares.push_back(rays.vignetting(u, v, corner_loss));
  }
  return shares;
}

}  // namespace

StereoRenderer::StereoRenderer(const StereoCalibration& calibration,
                               const SeasonScene& scene,
                               const Config& config,
                               std::uint64_t seed)
    : config_(config),
      scene_(&scene),
      light_(light_of(scene)),
      exposure_(config.exposure),
      cameras_{
          SingleCamera(calibration.cam0, calibration.T_body_cam0, config, CounterRandom(seed, 0)),
          SingleCamera(calibration.cam1, calibration.T_body_cam1, config, CounterRandom(seed, 1))} {
}

StereoRenderer::SingleCamera::SingleCamera(const Camera& camera,
                                           Pose T_body_camera,
                                           const Config& config,
                                           const CounterRandom& noise)
    : rays(camera),
      blocks(blocks_of(rays)),
      vignetting(vignetting_of(rays, config.corner_loss)),
      T_body_cam(std::move(T_body_camera)),
      response(config.noise, noise),
      image(camera.width_px, camera.height_px) {}

StereoFrame StereoRenderer::render(const Shot& shot, const Motion& T_map_body) {
  for (SingleCamera& camera : cameras_) expose(camera, shot, T_map_body);
  const std::vector<float>& metered = cameras_[0].image.radiance;
  double sum = 0.0;
  for (const float radiance : metered) sum += static_cast<double>(radiance);
  const auto mean = static_cast<float>(sum / static_cast<double>(metered.size()));
  const float gain = exposure_.next(shot.time_s, mean);
  return {.stamp = shot.stamp,
          .left = to_gray(cameras_[0], shot.frame, gain),
          .right = to_gray(cameras_[1], shot.frame, gain)};
}

void StereoRenderer::expose(SingleCamera& camera, const Shot& shot, const Motion& T_map_body) {
  const bool is_blurred = config_.motion_samples > 1;
  std::vector<float> sum(is_blurred ? camera.image.radiance.size() : 0);
  for (int i = 0; i < config_.motion_samples; ++i) {
    const double share = (i + 0.5) / config_.motion_samples - 0.5;
    const double time_s = shot.time_s + share * static_cast<double>(config_.exposure_time_s);
    const SceneView view = scene_->at(time_s);
    const Pose T_map_cam = T_map_body(time_s) * camera.T_body_cam;
    trace(camera, view, T_map_cam);
    add_sun(camera.image, config_.threads);
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += camera.image.radiance[k];
    if (config_.smooth_edges && !is_blurred) {
      smooth_edges(camera.image, {camera.rays, view, light_, T_map_cam}, config_.threads);
    }
  }
  if (!is_blurred) return;
  for (float& value : sum) value /= static_cast<float>(config_.motion_samples);
  camera.image.radiance = std::move(sum);
}

void StereoRenderer::trace(SingleCamera& camera, const SceneView& view, const Pose& T_map_cam) {
  const CameraView frame(T_map_cam);
  const int rows = rows_of_blocks(camera.rays.height_px());
  const std::size_t blocks_per_row = camera.blocks.size() / static_cast<std::size_t>(rows);
  for_each_row(rows, config_.threads, [&](int row) {
    const auto* block = &camera.blocks[static_cast<std::size_t>(row) * blocks_per_row];
    for (int first_u = 0; first_u < camera.rays.width_px(); first_u += PixelBlock::kWidth) {
      PixelBlock::Packets packets;
      for (std::size_t i = 0; i < packets.size(); ++i) {
        packets[i] = in_map((*block)[i], frame, camera.rays.pixel_rad());
      }
      const PixelBlock::Shaded seen = shade_block(view, light_, packets);
      const int first_v = row * PixelBlock::kHeight;
      for_each_pixel(camera.rays, first_u, first_v, [&](int u, int v, std::size_t i) {
        const std::size_t packet = i / RayPacket::kSize;
        const std::size_t lane = i % RayPacket::kSize;
        const std::size_t pixel = camera.rays.index(u, v);
        camera.image.radiance[pixel] = seen.packets[packet].radiance[lane];
        camera.image.sun[pixel] = seen.packets[packet].sun[lane];
        camera.image.keys[pixel] = seen.packets[packet].key[lane];
        camera.image.triangles[pixel] = seen.triangles[packet][lane];
        camera.image.sunlit[pixel] = (seen.sunlit[packet] >> lane) & 1U;
      });
      ++block;
    }
  });
}

cv::Mat StereoRenderer::to_gray(const SingleCamera& camera, std::uint64_t frame, float gain) const {
  const int width = camera.rays.width_px();
  cv::Mat image(camera.rays.height_px(), width, CV_8UC1);
  const auto columns = static_cast<std::size_t>(width);
  const std::uint64_t stride = (columns + 3) / 4 * 4;
  for_each_row(camera.rays.height_px(), config_.threads, [&](int row) {
    const auto index = static_cast<std::size_t>(row);
    std::vector<float> radiance(columns);
    for (std::size_t u = 0; u < columns; ++u) {
      const std::size_t pixel = index * columns + u;
      radiance[u] = camera.image.radiance[pixel] * camera.vignetting[pixel];
    }
    camera.response.respond(radiance,
                            {.frame = frame, .first_pixel = index * stride, .gain = gain},
                            std::span<std::uint8_t>(image.ptr<std::uint8_t>(row), columns));
  });
  return image;
}

}  // namespace fleetloc
