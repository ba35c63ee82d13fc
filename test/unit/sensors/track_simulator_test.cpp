#include "deploy/sim/sensors/track_simulator.hpp"

#include <cmath>
#include <map>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/sim/sensors/track_statistics.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::Le;
using ::testing::SizeIs;

/// Looks along z; x right, y down.
StereoCalibration cameras() {
  const Camera camera{.width_px = 640,
                      .height_px = 400,
                      .focal_px = {400.0, 400.0},
                      .center_px = {320.0, 200.0},
                      .coefficients = {-0.1, 0.02, 0.0, 0.0}};
  return {.cam0 = camera,
          .cam1 = camera,
          .T_body_cam0 = {},
          .T_body_cam1 = {.R = Eigen::Quaterniond::Identity(), .p = {0.3, 0.0, 0.0}}};
}

void add_quad(Mesh& mesh, const std::array<Eigen::Vector3f, 4>& corners) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  mesh.surfaces.insert(mesh.surfaces.end(), 2, 0U);
}

/// A wall across the view `z` metres away, from x = `left` to `right`.
void add_wall(Mesh& mesh, float z, float left, float right) {
  add_quad(mesh, {{{left, -20.0F, z}, {right, -20.0F, z}, {right, 20.0F, z}, {left, 20.0F, z}}});
}

/// Surface 0 is that of everything fixed.
SceneView view_of(const Mesh& mesh) {
  return {.caster = RayCaster(mesh), .surfaces = {Surface{}}};
}

SceneView wall_at_10_m() {
  Mesh mesh;
  add_wall(mesh, 10.0F, -100.0F, 100.0F);
  return view_of(mesh);
}

TrackModel noise_free() {
  TrackModel model;
  model.pixel_sigma = 0.0;
  model.drift_sigma = 0.0;
  model.disparity_sigma = 0.0;
  model.fleeting_share = 0.0;
  model.lasting_end_rate = 0.0;
  model.outlier_rate = 0.0;
  model.stereo_share = 1.0;
  return model;
}

Pose moved_right(double metres) {
  return {.R = Eigen::Quaterniond::Identity(), .p = {metres, 0.0, 0.0}};
}

Timestamp at(int frame) {
  return Timestamp(std::chrono::milliseconds(100 * frame));
}

/// Moves 2 cm to the right in each frame.
TrackStatistics statistics(const TrackModel& model, const SceneView& world, int frames) {
  TrackSimulator simulator(cameras(), model, 1);
  TrackAssessment assessment(rectified(cameras()));
  for (int i = 0; i < frames; ++i) {
    const Pose T_map_body = moved_right(0.02 * i);
    assessment.add(simulator.track(at(i), T_map_body, world), T_map_body, world);
  }
  return assessment.statistics();
}

TEST(TrackSimulator, SeesPointsOfTheWorldWhereTheyAreIfThereIsNoNoise) {
  const SceneView world = wall_at_10_m();
  TrackSimulator simulator(cameras(), noise_free(), 1);
  const RectifiedStereo stereo = rectified(cameras());
  std::map<LandmarkId, Eigen::Vector3d> points;
  for (int i = 0; i < 20; ++i) {
    const TrackedFrame frame = simulator.track(at(i), moved_right(0.1 * i), world);
    EXPECT_THAT(frame.observations, SizeIs(AllOf(Ge(120U), Le(150U))));
    for (const StereoObservation& seen : frame.observations) {
      if (seen.disparity == 0.0) continue;  // outside of the right image
      const double depth = stereo.focal_px * stereo.baseline_m / seen.disparity;
      EXPECT_NEAR(depth, 10.0, 1e-4);
      const Eigen::Vector2d tangent = (seen.left - stereo.center_px) / stereo.focal_px;
      const Eigen::Vector3d p_map = moved_right(0.1 * i) * (depth * tangent.homogeneous());
      const auto [known, is_new] = points.emplace(seen.landmark, p_map);
      EXPECT_LT((known->second - p_map).norm(), 1e-4);
    }
  }
  EXPECT_GT(points.size(), 150U);  // what leaves the image is replaced
}

TEST(TrackSimulator, HasTheNoiseThatIsStated) {
  TrackModel model = noise_free();
  model.pixel_sigma = 0.2;
  model.disparity_sigma = 0.15;
  const TrackStatistics white = statistics(model, wall_at_10_m(), 60);
  EXPECT_NEAR(white.pixel_sigma, 0.2, 0.01);
  EXPECT_NEAR(white.disparity_sigma, 0.15, 0.01);
  // The first pixel is taken for the truth: its noise and that of the later one, in two axes.
  EXPECT_NEAR(white.error_after_10_px, 0.2 * std::sqrt(2.0) * 1.1774, 0.03);
  EXPECT_EQ(white.outlier_share, 0.0);

  model.drift_sigma = 0.1;
  const TrackStatistics drifting = statistics(model, wall_at_10_m(), 60);
  EXPECT_NEAR(
      drifting.error_after_30_px, 1.1774 * std::sqrt(2.0 * 0.2 * 0.2 + 30.0 * 0.1 * 0.1), 0.06);
}

TEST(TrackSimulator, EndsTracksAtTheStatedRates) {
  TrackModel model = noise_free();
  model.lasting_end_rate = 0.1;  // ln 2 / 0.105 = 6.6 frames
  EXPECT_NEAR(statistics(model, wall_at_10_m(), 150).median_length_frames, 7.0, 1.0);
  model.fleeting_share = 1.0;
  model.fleeting_end_rate = 0.5;
  EXPECT_NEAR(statistics(model, wall_at_10_m(), 50).median_length_frames, 1.0, 1.0);
}

TEST(TrackSimulator, LetsOutliersSlideOff) {
  TrackModel model = noise_free();
  model.outlier_rate = 0.02;
  const double share = statistics(model, wall_at_10_m(), 100).outlier_share;
  EXPECT_GT(share, 0.05);
  EXPECT_LT(share, 0.9);
}

TEST(TrackSimulator, LosesWhatIsHidden) {
  Mesh mesh;
  add_wall(mesh, 10.0F, -100.0F, 100.0F);
  add_wall(mesh, 4.0F, 2.0F, 3.0F);
  const SceneView world = view_of(mesh);
  TrackSimulator simulator(cameras(), noise_free(), 1);
  const RectifiedStereo stereo = rectified(cameras());
  int behind = 0;
  int on_post = 0;
  for (int i = 0; i < 30; ++i) {
    const double x = 0.1 * i;
    for (const auto& seen : simulator.track(at(i), moved_right(x), world).observations) {
      const double right = (seen.left.x() - stereo.center_px.x()) / stereo.focal_px * 4.0 + x;
      if (right < 2.01 || right > 2.99) continue;
      if (seen.disparity == 0.0) continue;
      const double depth = stereo.focal_px * stereo.baseline_m / seen.disparity;
      (depth > 5.0 ? behind : on_post) += 1;
    }
  }
  EXPECT_EQ(behind, 0);
  EXPECT_GT(on_post, 20);
}

TEST(TrackSimulator, FollowsWhatMoves) {
  TrackSimulator simulator(cameras(), noise_free(), 1);
  const RectifiedStereo stereo = rectified(cameras());
  std::map<LandmarkId, double> first_x;
  for (int i = 0; i < 10; ++i) {
    Mesh mesh;  // a wall that fills the view and goes to the right
    add_wall(mesh, 10.0F, -100.0F, 100.0F);
    SceneView world = view_of(mesh);
    world.surfaces[0].frame.p_map.x() = 0.05F * static_cast<float>(i);
    for (const auto& seen : simulator.track(at(i), {}, world).observations) {
      const double x = (seen.left.x() - stereo.center_px.x()) / stereo.focal_px * 10.0;
      const auto [known, is_new] = first_x.emplace(seen.landmark, x - 0.05 * i);
      EXPECT_NEAR(x - 0.05 * i, known->second, 1e-4);
    }
  }
}

TEST(TrackSimulator, RepeatsItselfForOneSeedOnly) {
  const auto frames = [](std::uint64_t seed) {
    const SceneView world = wall_at_10_m();
    TrackSimulator simulator(cameras(), TrackModel{}, seed);
    std::vector<double> columns;
    for (int i = 0; i < 10; ++i) {
      for (const auto& seen : simulator.track(at(i), moved_right(0.1 * i), world).observations) {
        columns.push_back(seen.left.x());
      }
    }
    return columns;
  };
  EXPECT_EQ(frames(3), frames(3));
  EXPECT_NE(frames(3), frames(4));
}

TEST(TrackModel, RefusesAShareBeyondOne) {
  const auto text = [](double share) {
    return "{features: 150, min_distance_px: 15, border_px: 8, max_m: 60, pixel_sigma: 0.1, "
           "drift_sigma: 0.03, disparity_sigma: 0.1, fleeting_share: 0.3, fleeting_end_rate: 0.3, "
           "lasting_end_rate: 0.02, outlier_rate: 0.002, slide_px: 1, stereo_share: " +
           std::to_string(share) + "}";
  };
  EXPECT_EQ(read_track_model(ConfigReader::from_string(text(0.5))).stereo_share, 0.5);
  EXPECT_THROW(read_track_model(ConfigReader::from_string(text(1.5))), ConfigError);
}

}  // namespace
}  // namespace fleetloc
