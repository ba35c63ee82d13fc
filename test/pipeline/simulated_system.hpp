#pragma once

#include <memory>
#include <vector>

#include "cloud/laser_map/build_map.hpp"
#include "cloud/pool/simulated_cloud.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "shared/config/default_config.hpp"
#include "shared/link/memory_network.hpp"
#include "shared/simulation/simulated_run.hpp"

namespace fleetloc {

inline ConfigReader defaults() {
  return ConfigReader::from_string(std::string(default_config("everything")), "defaults");
}

/// Cameras without distortion whose rectified pair is `stereo`.
inline StereoCalibration ideal_cameras(const RectifiedStereo& stereo) {
  StereoCalibration calibration;
  calibration.cam0.width_px = 752;
  calibration.cam0.height_px = 480;
  calibration.cam0.focal_px.setConstant(stereo.focal_px);
  calibration.cam0.center_px = {376.0, 240.0};
  calibration.cam1 = calibration.cam0;
  calibration.T_body_cam0 = stereo.T_body_cam0;
  calibration.T_body_cam1 =
      stereo.T_body_cam0 * Pose{Eigen::Quaterniond::Identity(), {stereo.baseline_m, 0.0, 0.0}};
  return calibration;
}

/// The map of the simulated room; the map's frame is the room's.
inline std::shared_ptr<const LaserMap> map_of(const SimulatedRun& run) {
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p : run.surface_points(0.03)) points.push_back(p.cast<float>());
  return std::make_shared<const LaserMap>(
      build_map(points, "map", read_map_config(defaults().section("map"))));
}

/// A robot and a localizer over a link, in simulated time and on simulated tracks.
class SimulatedSystem {
 public:
  SimulatedSystem(const SimulatedRun& run,
                  std::shared_ptr<const LaserMap> map,
                  const LinkConfig& link,
                  const Pose& T_map_body_start)
      : run_(run),
        network_(link),
        robot_end_(network_.join_robot("robot")),
        cloud_end_(network_.join_cloud("localizer")),
        cloud_(LocalizerPool(
                   "localizer", Epoch{1}, std::move(map), read_localizer_pool_config(defaults())),
               *cloud_end_,
               std::chrono::milliseconds(50),
               {}),
        client_("robot", *robot_end_, read_cloud_client_config(defaults().section("client"))),
        back_end_(
            KeyframeWorker(run.stereo(), run.noise(), read_keyframe_worker_config(defaults()), {}),
            std::chrono::milliseconds(50)),
        pipeline_({.id = "robot",
                   .calibration = ideal_cameras(run.stereo()),
                   .imu_noise = run.noise(),
                   .T_map_body = T_map_body_start},
                  read_robot_pipeline_config(defaults()),
                  back_end_,
                  &client_) {}

  /// Plays everything up to `seconds`.
  void play(double seconds) {
    const auto end = Timestamp{from_seconds(seconds)};
    for (const ImuSample& sample : run_.imu(played_, end)) {
      pipeline_.add_imu(sample);
      cloud_.advance(sample.stamp);
      pipeline_.poll(sample.stamp);
      while (run_.frame_stamp(next_frame_) <= sample.stamp) {
        pipeline_.add_tracks(run_.frame(next_frame_++));
      }
      for (FrameOutput& frame : pipeline_.take_frames()) frames.push_back(std::move(frame));
      for (AnswerOutput& answer : pipeline_.take_answers()) answers.push_back(std::move(answer));
    }
    played_ = end + Duration(1);
  }

  [[nodiscard]] const CloudClient& client() const { return client_; }
  [[nodiscard]] const LocalizerPool& pool() const { return cloud_.pool(); }

  std::vector<FrameOutput> frames;
  std::vector<AnswerOutput> answers;

 private:
  const SimulatedRun& run_;
  MemoryNetwork network_;
  std::unique_ptr<Channel> robot_end_;
  std::unique_ptr<Channel> cloud_end_;
  SimulatedCloud cloud_;
  CloudClient client_;
  SimulatedBackEnd back_end_;
  RobotPipeline pipeline_;
  Timestamp played_;
  int next_frame_ = 0;
};

}  // namespace fleetloc
