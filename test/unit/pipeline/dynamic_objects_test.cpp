// What moves in view of the robot moves neither it nor what it knows of itself.
#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "deploy/replay/simulated_back_end.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "shared/geometry/pose.hpp"
#include "test/simulated_setup.hpp"

namespace fleetloc {
namespace {

constexpr double kBegin = 5.0;
constexpr double kEnd = 8.0;

struct Moving {
  double share;       // of what the robot sees
  double speed_px_s;  // across the image
};

class DynamicObjects : public testing::TestWithParam<Moving> {
 protected:
  /// Two in five tracks, say, are of something that begins to walk by.
  static void move(TrackedFrame& frame) {
    const double t = to_seconds(frame.stamp - Timestamp{});
    if (t < kBegin || t > kEnd) return;
    for (StereoObservation& seen : frame.observations) {
      constexpr std::uint32_t kOneIn = 100;
      const bool moves = static_cast<std::uint32_t>(seen.landmark) * 37 % kOneIn <
                         static_cast<std::uint32_t>(GetParam().share * kOneIn);
      if (moves) seen.left.x() += GetParam().speed_px_s * (t - kBegin);
    }
  }

  /// The robot's poses of [kBegin - 0.5, kEnd + 0.5], in odom.
  std::vector<FrameOutput> play() {
    const ConfigReader config = defaults();
    SimulatedBackEnd back_end(
        KeyframeWorker(run_.stereo(), run_.noise(), read_keyframe_worker_config(config), {}),
        std::chrono::milliseconds(50));
    RobotPipeline pipeline({.id = "robot",
                            .calibration = ideal_cameras(run_.stereo()),
                            .imu_noise = run_.noise(),
                            .T_map_body = std::nullopt},
                           read_robot_pipeline_config(config),
                           back_end,
                           nullptr);
    std::vector<FrameOutput> frames;
    int next_frame = 0;
    for (const ImuSample& sample : run_.imu(Timestamp{}, Timestamp{from_seconds(kEnd + 0.5)})) {
      if (const auto pose = pipeline.add_imu(sample)) pipeline.poll(pose->stamp);
      while (run_.frame_stamp(next_frame) <= sample.stamp) {
        TrackedFrame frame = run_.frame(next_frame++);
        move(frame);
        pipeline.add_frame(std::move(frame));
      }
      for (FrameOutput& frame : pipeline.take_frames()) {
        const double t = to_seconds(frame.stamp - Timestamp{});
        if (t >= kBegin - 0.5) frames.push_back(std::move(frame));
      }
    }
    return frames;
  }

  const SimulatedRun run_{noisy_flight()};
};

TEST_P(DynamicObjects, DoNotMoveTheOdometry) {
  const std::vector<FrameOutput> frames = play();
  ASSERT_GT(frames.size(), 70U);
  const auto truth = [&](const FrameOutput& frame) { return run_.truth(frame.stamp).T_odom_body; };
  const Pose T_odom_room = frames.front().pose.T_odom_body * inverse(truth(frames.front()));
  double worst_m = 0.0;
  for (const FrameOutput& frame : frames) {
    const Pose T_odom_body = T_odom_room * truth(frame);
    worst_m = std::max(worst_m, (frame.pose.T_odom_body.p - T_odom_body.p).norm());
  }
  std::cout << "worst " << worst_m << " m in 4 s\n";
  EXPECT_LT(worst_m, 0.04);
}

INSTANTIATE_TEST_SUITE_P(OfTheView,
                         DynamicObjects,
                         testing::Values(Moving{0.0, 0.0},
                                         Moving{0.2, 150.0},
                                         Moving{0.4, 150.0},
                                         Moving{0.4, 40.0},
                                         Moving{0.5, 100.0}));

}  // namespace
}  // namespace fleetloc
