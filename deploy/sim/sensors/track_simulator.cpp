#include "deploy/sim/sensors/track_simulator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace fleetloc {
namespace {

// Streams of random numbers.
constexpr std::uint64_t kLife = 1;
constexpr std::uint64_t kNoise = 2;
constexpr std::uint64_t kStereo = 3;
constexpr std::uint64_t kPlaces = 4;

// What is drawn for a landmark in each frame.
enum Noise : std::uint64_t { kPixelU, kPixelV, kDisparity, kDriftU, kDriftV, kNoises };
enum Chance : std::uint64_t { kIsFleeting, kEnds, kSlides, kDirection, kChances };

constexpr int kTriesPerFeature = 4;

double share(ConfigReader& config, const char* key) {
  const auto value = config.get<double>(key);
  if (!(value >= 0.0 && value <= 1.0)) throw ConfigError(std::string(key) + ": must be in 0..1");
  return value;
}

std::uint64_t index_of(LandmarkId landmark) {
  return static_cast<std::uint64_t>(landmark);
}

}  // namespace

TrackModel read_track_model(ConfigReader section) {
  constexpr int kMaxFeatures = 1000;
  TrackModel model;
  model.features = section.integer("features", 1, kMaxFeatures);
  model.min_distance_px = section.positive("min_distance_px");
  model.border_px = section.positive("border_px");
  model.max_m = section.positive("max_m");
  model.pixel_sigma = section.positive("pixel_sigma");
  model.drift_sigma = section.positive("drift_sigma");
  model.disparity_sigma = section.positive("disparity_sigma");
  model.fleeting_share = share(section, "fleeting_share");
  model.fleeting_end_rate = share(section, "fleeting_end_rate");
  model.lasting_end_rate = share(section, "lasting_end_rate");
  model.outlier_rate = share(section, "outlier_rate");
  model.slide_px = section.positive("slide_px");
  model.stereo_share = share(section, "stereo_share");
  return model;
}

TrackSimulator::TrackSimulator(const StereoCalibration& calibration,
                               const TrackModel& model,
                               std::uint64_t seed)
    : calibration_(calibration),
      stereo_(rectified(calibration)),
      model_(model),
      life_(seed, kLife),
      noise_(seed, kNoise),
      stereo_chance_(seed, kStereo),
      places_(seed, kPlaces) {}

TrackedFrame TrackSimulator::track(Timestamp stamp,
                                   const Pose& T_map_body,
                                   const SceneView& world) {
  seen_ = {.stamp = stamp, .observations = {}};
  follow(T_map_body, world);
  begin_tracks(T_map_body, world);
  ++frame_;
  return std::exchange(seen_, {});
}

bool TrackSimulator::is_in_image(const Camera& camera,
                                 const Pose& T_body_cam,
                                 const Eigen::Vector3d& p_body) const {
  const auto pixel = project(camera, inverse(T_body_cam) * p_body);
  return pixel && pixel->x() >= model_.border_px && pixel->y() >= model_.border_px &&
         pixel->x() <= camera.width_px - 1 - model_.border_px &&
         pixel->y() <= camera.height_px - 1 - model_.border_px;
}

/// (u, v, disparity) without noise; nothing where the point is not visible in the left camera.
std::optional<Eigen::Vector3d> TrackSimulator::ideal_observation(const Track& track,
                                                                 const Pose& T_map_body,
                                                                 const SceneView& world) const {
  const Eigen::Vector3d p_point_map = p_map(track.point, world);
  const Eigen::Vector3d p_body = inverse(T_map_body) * p_point_map;
  if (!is_in_image(calibration_.cam0, calibration_.T_body_cam0, p_body)) return std::nullopt;
  const Eigen::Vector3d p_cam0 = inverse(stereo_.T_body_cam0) * p_body;
  if (p_cam0.z() <= 0.0) return std::nullopt;
  const Eigen::Vector3d left_map = T_map_body * calibration_.T_body_cam0.p;
  if (world.caster.occluded(left_map.cast<float>(), p_point_map.cast<float>())) return std::nullopt;
  const Eigen::Vector3d seen = project(stereo_, p_cam0);
  return Eigen::Vector3d(seen.x(), seen.y(), seen.x() - seen.z());
}

bool TrackSimulator::is_visible_in_right(const Track& track,
                                         const Pose& T_map_body,
                                         const SceneView& world) const {
  const Eigen::Vector3d p_point_map = p_map(track.point, world);
  const Eigen::Vector3d p_body = inverse(T_map_body) * p_point_map;
  const Eigen::Vector3d right_map = T_map_body * calibration_.T_body_cam1.p;
  return is_in_image(calibration_.cam1, calibration_.T_body_cam1, p_body) &&
         !world.caster.occluded(right_map.cast<float>(), p_point_map.cast<float>());
}

bool TrackSimulator::outlives_frame(LandmarkId landmark, Track& track) const {
  const std::uint64_t id = index_of(landmark);
  const auto chance = [&](Chance kind) { return life_.uniform(id, kChances * frame_ + kind); };
  const double end_rate = track.is_fleeting ? model_.fleeting_end_rate : model_.lasting_end_rate;
  if (chance(kEnds) < end_rate) return false;
  if (!track.slides && chance(kSlides) < model_.outlier_rate) {
    track.slides = true;
    track.slide_direction = 2.0 * std::numbers::pi * chance(kDirection);
  }
  const auto normal = [&](Noise kind) { return noise_.normal(id, kNoises * frame_ + kind); };
  track.shift_px += model_.drift_sigma * Eigen::Vector2d(normal(kDriftU), normal(kDriftV));
  if (track.slides) {
    track.shift_px += model_.slide_px * Eigen::Vector2d(std::cos(track.slide_direction),
                                                        std::sin(track.slide_direction));
  }
  return true;
}

StereoObservation TrackSimulator::observe(LandmarkId landmark,
                                          const Track& track,
                                          const Eigen::Vector3d& ideal,
                                          bool is_visible_in_right) const {
  const std::uint64_t id = index_of(landmark);
  const auto normal = [&](Noise kind) { return noise_.normal(id, kNoises * frame_ + kind); };
  StereoObservation observation{.landmark = landmark};
  observation.left = ideal.head<2>() + track.shift_px +
                     model_.pixel_sigma * Eigen::Vector2d(normal(kPixelU), normal(kPixelV));
  const double disparity = ideal.z() + model_.disparity_sigma * normal(kDisparity);
  const bool is_matched =
      is_visible_in_right && stereo_chance_.uniform(id, frame_) < model_.stereo_share;
  if (is_matched && disparity > 0.0) observation.disparity = disparity;
  return observation;
}

void TrackSimulator::follow(const Pose& T_map_body, const SceneView& world) {
  for (auto it = tracks_.begin(); it != tracks_.end();) {
    auto& [landmark, track] = *it;
    const auto ideal = outlives_frame(landmark, track) ? ideal_observation(track, T_map_body, world)
                                                       : std::nullopt;
    if (!ideal) {
      it = tracks_.erase(it);
      continue;
    }
    seen_.observations.push_back(
        observe(landmark, track, *ideal, is_visible_in_right(track, T_map_body, world)));
    ++it;
  }
}

// As a corner detector with a mask around the present features.
void TrackSimulator::begin_tracks(const Pose& T_map_body, const SceneView& world) {
  const Camera& camera = calibration_.cam0;
  const Pose T_map_cam0 = T_map_body * calibration_.T_body_cam0;
  const int tries = kTriesPerFeature * model_.features;
  for (int i = 0; i < tries && std::ssize(seen_.observations) < model_.features; ++i) {
    const auto item = 2 * static_cast<std::uint64_t>(i);
    const Eigen::Vector2d pixel(
        model_.border_px + places_.uniform(frame_, item) * (camera.width_px - 2 * model_.border_px),
        model_.border_px +
            places_.uniform(frame_, item + 1) * (camera.height_px - 2 * model_.border_px));
    const auto ray_cam0 = unproject(camera, pixel);
    if (!ray_cam0) continue;
    const Eigen::Vector3d direction_map = T_map_cam0.R * ray_cam0->normalized();
    const auto point = first_point(T_map_cam0.p, direction_map, model_.max_m, world);
    if (point) begin_track(*point, T_map_body, world);
  }
}

void TrackSimulator::begin_track(const AnchoredPoint& point,
                                 const Pose& T_map_body,
                                 const SceneView& world) {
  Track track{.point = point};
  const auto ideal = ideal_observation(track, T_map_body, world);
  if (!ideal) return;
  const auto is_near = [&](const StereoObservation& other) {
    return (other.left - ideal->head<2>()).norm() < model_.min_distance_px;
  };
  if (std::ranges::any_of(seen_.observations, is_near)) return;
  const LandmarkId landmark{next_landmark_++};
  track.is_fleeting =
      life_.uniform(index_of(landmark), kChances * frame_ + kIsFleeting) < model_.fleeting_share;
  seen_.observations.push_back(
      observe(landmark, track, *ideal, is_visible_in_right(track, T_map_body, world)));
  tracks_.emplace(landmark, std::move(track));
}

}  // namespace fleetloc
