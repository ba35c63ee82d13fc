#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "deploy/replay/simulated_back_end.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "test/simulated_setup.hpp"

namespace fleetloc {

/// A robot in simulated time and on simulated tracks, with its output.
class SimulatedRobot {
 public:
  /// @param T_map_body_start  nothing: nobody has told it
  SimulatedRobot(const SimulatedRun& run,
                 Channel& channel,
                 const std::optional<Pose>& T_map_body_start)
      : run_(run),
        client_("robot", channel, read_cloud_client_config(defaults().section("client"))),
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

  /// Plays everything up to `seconds`, and calls `advance` with each stamp of the IMU in between.
  void play(double seconds, const std::function<void(Timestamp)>& advance) {
    const auto end = Timestamp{from_seconds(seconds)};
    for (const ImuSample& sample : run_.imu(played_, end)) {
      pipeline_.add_imu(sample).value();
      advance(sample.stamp);
      pipeline_.poll(sample.stamp);
      while (run_.frame_stamp(next_frame_) <= sample.stamp) {
        TrackedFrame frame = run_.frame(next_frame_++);
        if (disturb) disturb(frame);
        pipeline_.add_frame(std::move(frame));
      }
      for (FrameOutput& frame : pipeline_.take_frames()) frames.push_back(std::move(frame));
      for (LocalizationOutput& answer : pipeline_.take_answers())
        answers.push_back(std::move(answer));
      for (std::string& event : client_.take_events()) events.push_back(std::move(event));
    }
    played_ = end + Duration(1);
  }

  void place(const GivenPose& given) { pipeline_.place(given); }

  [[nodiscard]] const CloudClient& client() const { return client_; }

  [[nodiscard]] const RobotPipeline& pipeline() const { return pipeline_; }

  std::function<void(TrackedFrame&)> disturb;  ///< what the cameras see
  std::vector<FrameOutput> frames;
  std::vector<LocalizationOutput> answers;
  std::vector<std::string> events;

 private:
  const SimulatedRun& run_;
  CloudClient client_;
  SimulatedBackEnd back_end_;
  RobotPipeline pipeline_;
  Timestamp played_;
  int next_frame_ = 0;
};

}  // namespace fleetloc
