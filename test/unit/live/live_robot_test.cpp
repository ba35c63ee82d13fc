// A robot whose sensors are live: images and IMU of a simulated flight, as they arrive.
#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "deploy/replay/simulated_back_end.hpp"
#include "robot/live/sensor_assembler.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "test/simulated_setup.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

constexpr Duration kStart = 24h * 365 * 50;  // of the sensors' clock
constexpr Duration kImuDelay = 1ms;
constexpr Duration kImageDelay = 17ms;

/// Images with a spot at each observation; its brightness and size are the landmark's.
class SpotCamera {
 public:
  explicit SpotCamera(const StereoCalibration& cameras, const RectifiedStereo& stereo)
      : size_(cameras.cam0.width_px, cameras.cam0.height_px),
        shift_(cameras.cam0.center_px - stereo.center_px) {}

  [[nodiscard]] StereoFrame images(const TrackedFrame& tracks) const {
    cv::Mat left(size_, CV_32FC1, cv::Scalar(60.0));
    cv::Mat right = left.clone();
    for (const StereoObservation& seen : tracks.observations) {
      draw(left, seen.left + shift_, seen.landmark);
      if (seen.disparity <= 0.0) continue;
      draw(right, seen.left + shift_ - Eigen::Vector2d(seen.disparity, 0.0), seen.landmark);
    }
    StereoFrame frame{.stamp = tracks.stamp, .left = {}, .right = {}};
    left.convertTo(frame.left, CV_8U);
    right.convertTo(frame.right, CV_8U);
    return frame;
  }

 private:
  static void draw(cv::Mat& image, const Eigen::Vector2d& center, LandmarkId landmark) {
    constexpr int kRadius = 6;
    const auto id = static_cast<std::uint32_t>(landmark);
    const double brightness = 60.0 + id * 37 % 130;
    const double variance = 1.5 + 0.5 * (id % 4);
    const int u0 = static_cast<int>(std::lround(center.x()));
    const int v0 = static_cast<int>(std::lround(center.y()));
    for (int v = std::max(0, v0 - kRadius); v <= std::min(image.rows - 1, v0 + kRadius); ++v) {
      for (int u = std::max(0, u0 - kRadius); u <= std::min(image.cols - 1, u0 + kRadius); ++u) {
        const double squared = (Eigen::Vector2d(u, v) - center).squaredNorm();
        image.at<float>(v, u) +=
            static_cast<float>(brightness * std::exp(-0.5 * squared / variance));
      }
    }
  }

  cv::Size size_;
  Eigen::Vector2d shift_;
};

/// A robot without a localizer.
struct Robot {
  explicit Robot(const SimulatedRun& run)
      : back_end(
            KeyframeWorker(run.stereo(), run.noise(), read_keyframe_worker_config(defaults()), {}),
            30ms),
        pipeline({.id = "robot",
                  .calibration = ideal_cameras(run.stereo()),
                  .imu_noise = run.noise(),
                  .T_map_body = run.truth(Timestamp{}).T_odom_body},
                 read_robot_pipeline_config(defaults()),
                 back_end,
                 nullptr) {}

  void add(SensorMeasurement measurement) {
    if (const auto* sample = std::get_if<ImuSample>(&measurement)) {
      if (const auto pose = pipeline.add_imu(*sample)) pipeline.poll(pose->stamp);
    } else if (const auto* step = std::get_if<ClockStep>(&measurement)) {
      pipeline.step_clock(*step);
    } else {
      pipeline.add_frame(std::get<CameraFrame>(std::move(measurement)));
    }
    for (FrameOutput& frame : pipeline.take_frames()) frames.push_back(std::move(frame));
  }

  SimulatedBackEnd back_end;
  RobotPipeline pipeline;
  std::vector<FrameOutput> frames;
};

class LiveRobot : public testing::Test {
 protected:
  LiveRobot() {
    SimulatedRun::Config config = noisy_flight();
    config.pixel_sigma = 0.0;
    config.features_per_frame = 250;
    run_.emplace(config);
    robot_.emplace(*run_);
    live_.emplace(*run_);
    cameras_.emplace(ideal_cameras(run_->stereo()), run_->stereo());
  }

  StereoFrame images(int index) {
    StereoFrame frame = cameras_->images(run_->frame(index));
    frame.stamp += kStart;
    return frame;
  }

  /// As from a recording.
  void play_directly(Duration length) {
    int next = 0;
    for (ImuSample sample : run_->imu(Timestamp{}, Timestamp{length})) {
      const Timestamp time = sample.stamp;
      sample.stamp += kStart;
      robot_->add(sample);
      while (run_->frame_stamp(next) <= time) robot_->add(CameraFrame(images(next++)));
    }
  }

  /// Each message arrives after its delay, stamped by a clock that is `ahead` then.
  void play_live(Duration length, Duration right_later, std::function<Duration(Timestamp)> ahead) {
    SensorAssembler assembler({}, {"/left", "/right", "/imu"}, ideal_cameras(run_->stereo()));
    int next = 0;
    for (ImuSample sample : run_->imu(Timestamp{}, Timestamp{length})) {
      const Timestamp now = sample.stamp + kImuDelay;
      while (run_->frame_stamp(next) + kImageDelay <= now) {
        StereoFrame frame = images(next++);
        frame.stamp += ahead(frame.stamp - kStart);
        const ArrivalTime arrival{(run_->frame_stamp(next - 1) + kImageDelay).time_since_epoch()};
        assembler.add_left(frame.stamp, frame.left, arrival);
        assembler.add_right(frame.stamp + right_later, frame.right, arrival);
        take_from(assembler);
      }
      sample.stamp += kStart + ahead(sample.stamp);
      assembler.add_imu(sample, ArrivalTime{now.time_since_epoch()});
      take_from(assembler);
    }
    faults_ = assembler.faults();
  }

  void take_from(SensorAssembler& assembler) {
    while (auto measurement = assembler.take()) live_->add(std::move(*measurement));
  }

  [[nodiscard]] static bool is_tracking(const Robot& robot) {
    return robot.pipeline.odometry().phase() == VisualInertialOdometry::Phase::kTracking;
  }

  std::optional<SimulatedRun> run_;
  std::optional<Robot> robot_;  // plays directly
  std::optional<Robot> live_;
  std::optional<SpotCamera> cameras_;
  std::map<std::string, std::uint64_t> faults_;
};

TEST_F(LiveRobot, ComputesBitByBitWhatItDoesFromARecording) {
  play_directly(5s);
  play_live(5s, 0ms, [](Timestamp) { return Duration{}; });
  ASSERT_TRUE(is_tracking(*robot_) && is_tracking(*live_));
  ASSERT_GE(live_->frames.size(), 99U);
  for (std::size_t i = 0; i < live_->frames.size(); ++i) {
    const FrameOutput& live = live_->frames[i];
    const FrameOutput& direct = robot_->frames[i];
    EXPECT_EQ(live.stamp, direct.stamp);
    EXPECT_EQ(live.tracks, direct.tracks);
    EXPECT_EQ(live.keyframe, direct.keyframe);
    EXPECT_EQ(live.pose.T_odom_body.p, direct.pose.T_odom_body.p) << i;
    EXPECT_EQ(live.pose.T_odom_body.R.coeffs(), direct.pose.T_odom_body.R.coeffs()) << i;
  }
  EXPECT_EQ(
      faults_,
      (std::map<std::string, std::uint64_t>{{"dropped_backlog", 0}, {"dropped_imu_backlog", 0}}));
}

TEST_F(LiveRobot, TracksAgainAfterItsClockWasSetBackByTenSeconds) {
  play_live(9s, 3ms, [](Timestamp time) { return time < Timestamp{5s} ? 0s : -10s; });
  EXPECT_EQ(faults_.at("clock_steps"), 1U);
  EXPECT_EQ(live_->pipeline.odometry().statistics().resets, 1U);
  EXPECT_TRUE(is_tracking(*live_));
  EXPECT_EQ(live_->frames.back().stamp, Timestamp{kStart + 8950ms - 10s});
  const auto truth = [&](const FrameOutput& frame, Duration ahead) {
    return run_->truth(frame.stamp - kStart - ahead).T_odom_body;
  };
  // odom goes on: the way from before the step to the end is the true one, but for what was not
  // seen of it.
  const auto before = std::ranges::find_if(live_->frames, [](const FrameOutput& frame) {
    return frame.stamp == Timestamp{kStart + 4900ms};
  });
  ASSERT_NE(before, live_->frames.end());
  const Pose T_odom = before->pose.T_odom_body;
  const FrameOutput& last = live_->frames.back();
  const Pose moved = inverse(T_odom) * last.pose.T_odom_body;
  const Pose true_moved = inverse(truth(*before, 0s)) * truth(last, -10s);
  EXPECT_LT((moved.p - true_moved.p).norm(), 1.5);
}

}  // namespace
}  // namespace fleetloc
