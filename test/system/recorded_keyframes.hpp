#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cloud/laser_map/laser_map.hpp"
#include "cloud/localizer/session_localizer.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/observation.hpp"
#include "shared/model/session.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// The observations of the robot's tracking in one stereo pair, and its true pose.
struct RecordedKeyframe {
  Timestamp stamp;
  Pose T_map_body;  ///< ground truth
  std::vector<StereoObservation> observations;
};

/// Stereo pairs with gaps of seconds between them, and a scan of the place.
struct RecordedKeyframes {
  RectifiedStereo stereo;
  std::vector<RecordedKeyframe> keyframes;
  std::shared_ptr<const LaserMap> map;
};

/// Features are detected anew in every pair, so that no track spans two pairs. Pairs without ground
/// truth are left out.
/// @param tracking  of the robot, YAML: what differs from the defaults
RecordedKeyframes read_keyframes(const std::filesystem::path& dataset, const std::string& tracking);

/// Errors added to the truth. Directions are random, by the seed; magnitudes are as given.
struct Disturbance {
  double start_m;
  double start_rad;
  double edge_m_per_m;
  double edge_rad;
  double tilt_rad;  ///< of roll and pitch as the robot measures them
  std::uint64_t seed;
};

/// The submaps of a robot for `count` successive pairs: one for each, with an edge to the one
/// before. `odom` begins at the first of them.
class KeyframeRun {
 public:
  KeyframeRun(const RecordedKeyframes& recorded,
              std::size_t first,
              std::size_t count,
              const Disturbance& disturbance);

  [[nodiscard]] const RobotSession& session() const { return session_; }
  [[nodiscard]] const std::vector<Submap>& submaps() const { return submaps_; }
  [[nodiscard]] const Pose& truth() const { return truth_; }  ///< of the last pair

 private:
  RobotSession session_;
  std::vector<Submap> submaps_;
  Pose truth_;
};

}  // namespace fleetloc
