#pragma once

#include <gtest/gtest.h>

#include "deploy/replay/simulated_back_end.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "test/simulated_setup.hpp"
#include "test/truthful_localizer.hpp"

namespace fleetloc {

/// A robot on a flight through the simulated room, whose submaps are answered at once: by the
/// truth, or metres beside it.
class AnsweredRobot : public testing::Test {
 protected:
  void play(double seconds) {
    const auto end = Timestamp{from_seconds(seconds)};
    for (const ImuSample& sample : run_.imu(played_, end)) {
      now_ = pipeline_.add_imu(sample).value();
      pipeline_.poll(sample.stamp);
      while (run_.frame_stamp(next_frame_) <= sample.stamp) {
        static_cast<void>(pipeline_.add_frame(run_.frame(next_frame_++)));
      }
    }
    played_ = end + Duration(1);
  }
  [[nodiscard]] Pose truth(double t) const {
    return run_.truth(Timestamp{from_seconds(t)}).T_odom_body;
  }
  /// Of the pose now by the start that was announced last.
  [[nodiscard]] double start_error_m() const {
    const auto& start = localizer_.sessions.back().start;
    return ((start->T_map_odom * now_.T_odom_body).p - run_.truth(now_.stamp).T_odom_body.p).norm();
  }

  const SimulatedRun run_{noisy_flight()};
  double off_m_ = 0.0;  // of the answers
  TruthfulLocalizer localizer_{[this](Timestamp stamp) {
    Pose T_map_body = run_.truth(stamp).T_odom_body;
    T_map_body.p.x() += off_m_;
    return T_map_body;
  }};
  SimulatedBackEnd back_end_{
      KeyframeWorker(run_.stereo(), run_.noise(), read_keyframe_worker_config(defaults()), {}),
      std::chrono::milliseconds(50)};
  RobotPipeline pipeline_{{.id = "robot",
                           .calibration = ideal_cameras(run_.stereo()),
                           .imu_noise = run_.noise(),
                           .session = SessionNumber{7},
                           .program_start = {},
                           .T_map_body = {},
                           .region = StartRegion{.name = "hall_B"}},
                          read_robot_pipeline_config(defaults()),
                          back_end_,
                          &localizer_};
  PoseEstimate now_;
  Timestamp played_;
  int next_frame_ = 0;
};

}  // namespace fleetloc
