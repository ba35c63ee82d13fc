#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "deploy/sim/sensors/anchored_point.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/core/counter_random.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// Model of the tracks of a KLT front end, without images. Visibility follows from the world's
/// geometry; the rest is stated here.
struct TrackModel {
  int features = 150;              ///< wanted in each frame
  double min_distance_px = 15;     ///< between features where a new one begins
  double border_px = 8;            ///< of the images that holds no feature
  double max_m = 60;               ///< farther points are not chosen
  double pixel_sigma = 0.1;        ///< of each observation, independent [px]
  double drift_sigma = 0.03;       ///< of a feature on its surface, in each frame [px]
  double disparity_sigma = 0.1;    ///< independent [px]
  double fleeting_share = 0.3;     ///< of the features: short-lived, these end
  double fleeting_end_rate = 0.3;  ///< with this probability in each frame, and
  double lasting_end_rate = 0.02;  ///< the others with this one
  double outlier_rate = 0.002;     ///< with which a feature begins to slide off, in each frame
  double slide_px = 1.0;           ///< how far it then goes in each frame
  double stereo_share = 0.95;      ///< share of the landmarks visible in both that has a disparity
};

/// Throws ConfigError.
TrackModel read_track_model(ConfigReader section);

/// Feature tracks of a stereo camera that moves through a world. Landmarks are points of visible
/// surfaces. Deterministic: the same calls give the same tracks.
class TrackSimulator {
 public:
  TrackSimulator(const StereoCalibration& calibration, const TrackModel& model, std::uint64_t seed);

  /// Observations in the rectified pair.
  /// @param world  at that time
  TrackedFrame track(Timestamp stamp, const Pose& T_map_body, const SceneView& world);

 private:
  struct Track {
    AnchoredPoint point;
    bool is_fleeting = false;
    bool slides = false;
    double slide_direction = 0.0;                        // in the image [rad]
    Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  // drift and sliding so far
  };

  [[nodiscard]] std::optional<Eigen::Vector3d> ideal_observation(const Track& track,
                                                                 const Pose& T_map_body,
                                                                 const SceneView& world) const;
  [[nodiscard]] bool is_visible_in_right(const Track& track,
                                         const Pose& T_map_body,
                                         const SceneView& world) const;
  bool outlives_frame(LandmarkId landmark, Track& track) const;
  void follow(const Pose& T_map_body, const SceneView& world);
  void begin_tracks(const Pose& T_map_body, const SceneView& world);
  void begin_track(const AnchoredPoint& point, const Pose& T_map_body, const SceneView& world);
  [[nodiscard]] StereoObservation observe(LandmarkId landmark,
                                          const Track& track,
                                          const Eigen::Vector3d& ideal,
                                          bool is_visible_in_right) const;
  [[nodiscard]] bool is_in_image(const Camera& camera,
                                 const Pose& T_body_cam,
                                 const Eigen::Vector3d& p_body) const;

  StereoCalibration calibration_;
  RectifiedStereo stereo_;
  TrackModel model_;
  CounterRandom life_;
  CounterRandom noise_;
  CounterRandom stereo_chance_;
  CounterRandom places_;
  std::uint64_t frame_ = 0;
  std::uint32_t next_landmark_ = 0;
  std::map<LandmarkId, Track> tracks_;
  TrackedFrame seen_;  // the current frame
};

}  // namespace fleetloc
