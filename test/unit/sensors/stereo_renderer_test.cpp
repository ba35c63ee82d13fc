#include "deploy/sim/sensors/stereo_renderer.hpp"

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include "deploy/sim/sensors/landmark_survey.hpp"
#include "deploy/sim/sensors/pixel_block.hpp"
#include "test/unit/sensors/campus_cameras.hpp"
#include "test/unit/world/campus.hpp"

namespace fleetloc {
namespace {

class StereoRendererOnCampus : public testing::TestWithParam<const char*> {
 protected:
  static const WorldConfig& world() {
    static const WorldConfig only = campus();
    return only;
  }
  static const Scene& scene() {
    static const Scene only = build_scene(world().scene, eight(), 1);
    return only;
  }
  static StereoFrame rendered(const SeasonScene& season,
                              const Pose& T_map_body,
                              int threads,
                              std::uint64_t seed = 1) {
    StereoRenderer renderer(campus_cameras(), season, camera_settings(threads), seed);
    return renderer.render({.stamp = {}, .time_s = 5.0, .frame = 3},
                           [&](double) { return T_map_body; });
  }
};

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.at(values.size() / 2);
}

TEST(ViewRays, ShowAPointWhereTheCameraModelPutsIt) {
  Mesh wall;  // oblique, 3 to 9 m away
  wall.vertices = {{-20, -20, 3}, {20, -20, 9}, {20, 20, 9}, {-20, 20, 3}};
  wall.triangles = {{0, 1, 2}, {0, 2, 3}};
  wall.surfaces = {0, 0};
  const RayCaster caster(wall);
  const StereoCalibration cameras = campus_cameras();
  for (const Camera& camera : {cameras.cam0, cameras.cam1}) {
    const ViewRays rays(camera);
    double largest = 0.0;
    for (int v = 0; v < camera.height_px; v += 7) {
      for (int u = 0; u < camera.width_px; u += 7) {
        const auto hit = caster.first_hit({Eigen::Vector3f::Zero(), rays.direction(u, v)}, 100.0F);
        if (!hit) continue;
        const auto pixel = project(camera, (hit->distance_m * rays.direction(u, v)).cast<double>());
        ASSERT_TRUE(pixel);
        largest = std::max(largest, (*pixel - Eigen::Vector2d(u, v)).norm());
      }
    }
    EXPECT_GT(largest, 0.0);
    EXPECT_LT(largest, 0.02);
  }
}

TEST_F(StereoRendererOnCampus, TheSameBytesWithAnyNumberOfThreads) {
  const SeasonScene season = season_of(world(), scene(), "winter");
  const Pose T_map_body = T_map_body_on_eight(0.3);
  const StereoFrame one = rendered(season, T_map_body, 1);
  for (const int threads : {2, 3}) {
    const StereoFrame other = rendered(season, T_map_body, threads);
    EXPECT_TRUE(same_bytes(one.left, other.left));
    EXPECT_TRUE(same_bytes(one.right, other.right));
  }
  EXPECT_FALSE(same_bytes(one.left, rendered(season, T_map_body, 2, 9).left));
  EXPECT_FALSE(same_bytes(one.left, one.right));
}

/// Rays of a block of the left camera's image.
PixelBlock::Packets block_at(const ViewRays& rays,
                             const Pose& T_map_cam,
                             int first_u,
                             int first_v) {
  constexpr auto kOffsets = PixelBlock::lattice_first();
  PixelBlock::Packets packets{};
  for (std::size_t i = 0; i < kOffsets.size(); ++i) {
    const Eigen::Vector3f& direction_cam =
        rays.direction(first_u + kOffsets[i].u, first_v + kOffsets[i].v);
    const Eigen::Vector3f direction = T_map_cam.R.cast<float>() * direction_cam;
    ViewPacket& packet = packets.at(i / RayPacket::kSize);
    const std::size_t lane = i % RayPacket::kSize;
    packet.pixel_rad = rays.pixel_rad();
    packet.rays.origin_x[lane] = static_cast<float>(T_map_cam.p.x());
    packet.rays.origin_y[lane] = static_cast<float>(T_map_cam.p.y());
    packet.rays.origin_z[lane] = static_cast<float>(T_map_cam.p.z());
    packet.rays.direction_x[lane] = direction.x();
    packet.rays.direction_y[lane] = direction.y();
    packet.rays.direction_z[lane] = direction.z();
    packet.rays.max_m[lane] = 500.0F;
  }
  return packets;
}

TEST_F(StereoRendererOnCampus, ABlockShowsWhatEachOfItsRaysMeets) {
  const SeasonScene season = season_of(world(), scene(), "autumn");
  const SceneView view = season.at(5.0);
  const Light light = light_of(season);
  const ViewRays rays(campus_cameras().cam0);
  int pixels = 0;
  int others = 0;  // that show another object
  int shadows = 0;
  for (const double share : {0.05, 0.3, 0.62}) {
    const Pose T_map_cam = T_map_body_on_eight(share) * campus_cameras().T_body_cam0;
    for (int v = 0; v < rays.height_px(); v += PixelBlock::kHeight) {
      for (int u = 0; u < rays.width_px(); u += PixelBlock::kWidth) {
        const PixelBlock::Packets packets = block_at(rays, T_map_cam, u, v);
        const PixelBlock::Shaded seen = shade_block(view, light, packets);
        for (std::size_t i = 0; i < packets.size(); ++i) {
          const HitPacket hits = view.caster.first_hits(packets[i].rays);
          const ShadedPacket alone = shade(view, light, packets[i], hits);
          const std::uint32_t sunlit_alone = sunlit(view, light, packets[i], hits);
          for (std::size_t lane = 0; lane < RayPacket::kSize; ++lane, ++pixels) {
            if (alone.key[lane] != seen.packets[i].key[lane]) ++others;
            const bool differs = (((seen.sunlit[i] ^ sunlit_alone) >> lane) & 1U) != 0U;
            if (differs && alone.sun[lane] > 0.0F) ++shadows;
          }
        }
      }
    }
  }
  std::printf(
      "of %d pixels, %d show another object and %d another shadow\n", pixels, others, shadows);
  EXPECT_LT(others, pixels / 500);
  EXPECT_LT(shadows, pixels / 200);
}

TEST(PixelBlock, ItsLatticeMeetsEveryRowAndColumn) {
  constexpr auto kOffsets = PixelBlock::lattice_first();
  std::set<int> columns;
  std::set<int> rows;
  std::set<std::pair<int, int>> all;
  for (std::size_t i = 0; i < kOffsets.size(); ++i) {
    all.emplace(kOffsets[i].u, kOffsets[i].v);
    if (i >= RayPacket::kSize) continue;
    columns.insert(kOffsets[i].u);
    rows.insert(kOffsets[i].v);
  }
  EXPECT_EQ(all.size(), std::size_t{PixelBlock::kPixels});
  EXPECT_EQ(columns.size(), std::size_t{PixelBlock::kWidth});
  EXPECT_EQ(rows.size(), std::size_t{PixelBlock::kHeight});
}

/// Distances of what the optical flow finds from where the landmarks are in the second image [px].
std::vector<double> flow_errors(const StereoFrame& first,
                                const StereoFrame& second,
                                const std::vector<VisibleLandmark>& landmarks,
                                const Camera& camera,
                                const Pose& T_cam_map) {
  std::vector<cv::Point2f> from;
  from.reserve(landmarks.size());
  for (const VisibleLandmark& landmark : landmarks) from.push_back(landmark.pixel);
  std::vector<cv::Point2f> to;
  std::vector<unsigned char> found;
  cv::calcOpticalFlowPyrLK(first.left, second.left, from, to, found, cv::noArray(), {21, 21}, 3);
  std::vector<double> errors;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const auto pixel = project(camera, T_cam_map * landmarks[i].p_map);
    if (!pixel || found[i] == 0) continue;
    const bool inside = pixel->x() > 12 && pixel->y() > 12 && pixel->x() < 628 && pixel->y() < 388;
    if (inside) errors.push_back((*pixel - Eigen::Vector2d(to[i].x, to[i].y)).norm());
  }
  return errors;
}

TEST_P(StereoRendererOnCampus, FlowOfCornersIsTheTrueOne) {
  const SeasonScene season = season_of(world(), scene(), GetParam());
  const StereoCalibration cameras = campus_cameras();
  std::vector<double> errors;
  for (const double share : {0.05, 0.3, 0.62, 0.9}) {
    const Pose before = T_map_body_on_eight(share);
    const Pose after = T_map_body_on_eight(share + 0.0004, 0.01);
    const StereoFrame first = rendered(season, before, 2);
    const StereoFrame second = rendered(season, after, 2);
    const auto landmarks = visible_landmarks(
        first.left, season.at(5.0).caster, cameras.cam0, before * cameras.T_body_cam0, 300);
    EXPECT_GE(landmarks.size(), 150U);
    const Pose T_cam_map = inverse(after * cameras.T_body_cam0);
    const auto some = flow_errors(first, second, landmarks, cameras.cam0, T_cam_map);
    errors.insert(errors.end(), some.begin(), some.end());
  }
  ASSERT_GE(errors.size(), 400U);
  const auto gross = std::ranges::count_if(errors, [](double error) { return error > 2.0; });
  const double gross_share = static_cast<double>(gross) / static_cast<double>(errors.size());
  std::printf("%s: median %.3f px, beyond 2 px %.3f\n", GetParam(), median(errors), gross_share);
  EXPECT_LT(median(errors), 0.2);
  EXPECT_LT(gross_share, 0.08);
}
INSTANTIATE_TEST_SUITE_P(InSession,
                         StereoRendererOnCampus,
                         testing::Values("summer", "winter"),
                         [](const auto& season) { return std::string(season.param); });

TEST_F(StereoRendererOnCampus, HardSessionShowsMuchThatTheMapDoesNotHave) {
  const SeasonScene survey = season_of(world(), scene(), "summer");
  const StereoCalibration cameras = campus_cameras();
  const auto share_in = [&](const std::string& name) {
    const SeasonScene season = season_of(world(), scene(), name);
    std::vector<VisibleLandmark> all;
    for (int i = 0; i < 12; ++i) {
      const Pose T_map_body = T_map_body_on_eight(i / 12.0);
      const StereoFrame frame = rendered(season, T_map_body, 2);
      const auto seen = visible_landmarks(
          frame.left, season.at(5.0).caster, cameras.cam0, T_map_body * cameras.T_body_cam0, 300);
      all.insert(all.end(), seen.begin(), seen.end());
    }
    return unmapped_share(all, survey.fixed());
  };
  const double autumn = share_in("autumn");
  const double winter = share_in("winter");
  std::printf("unmapped: autumn %.2f, winter %.2f\n", autumn, winter);
  EXPECT_GT(autumn, 0.0);
  EXPECT_GE(winter, 0.3);
  EXPECT_LE(winter, 0.6);
}

TEST(Exposure, FollowsTheSceneWithALag) {
  Exposure exposure({.target_gray = 100.0F, .lag_s = 0.5F, .min_gain = 10.0F, .max_gain = 1e4F});
  EXPECT_FLOAT_EQ(exposure.next(0.0, 0.5F), 200.0F);
  const float soon = exposure.next(0.05, 0.05F);
  EXPECT_GT(soon, 200.0F);
  EXPECT_LT(soon, 300.0F);
  EXPECT_NEAR(exposure.next(10.0, 0.05F), 2000.0F, 1.0F);
  EXPECT_NEAR(exposure.next(60.0, 1e-9F), 1e4F, 1.0F);
}

TEST(PixelResponse, NoiseHasTheStatedSpread) {
  const PixelResponse response({.read_gray = 2.0F, .shot_gray = 0.05F, .reference_gain = 100.0F},
                               CounterRandom(1, 0));
  const std::vector<float> radiance(40000, 0.5F);
  std::vector<std::uint8_t> gray(radiance.size());
  response.respond(radiance, {.frame = 1, .first_pixel = 0, .gain = 200.0F}, gray);
  double sum = 0.0;
  double squares = 0.0;
  for (const std::uint8_t value : gray) {
    sum += value;
    squares += value * static_cast<double>(value);
  }
  const double mean = sum / static_cast<double>(gray.size());
  EXPECT_NEAR(mean, 100.0, 0.1);
  // read 2 * 2, shot 0.05 * 2 * 100, and 1 / 12 of rounding
  EXPECT_NEAR(
      squares / static_cast<double>(gray.size()) - mean * mean, 16.0 + 10.0 + 1.0 / 12.0, 0.6);
}

}  // namespace
}  // namespace fleetloc
