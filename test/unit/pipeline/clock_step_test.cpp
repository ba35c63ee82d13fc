// The clock of the sensors is set while a robot flies: on simulated tracks, with a localizer that
// knows the truth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/replay/simulated_back_end.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "test/simulated_setup.hpp"
#include "test/truthful_localizer.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

constexpr Duration kUnseen = 5ms;

TEST(ContinuousTime, GivesStampsByTheClockAsItWasThen) {
  const auto at = [](Duration time) { return Timestamp{time}; };
  ContinuousTime time;
  EXPECT_EQ(time.time_of(at(7s)), at(7s));
  time.step(at(2s), at(10s));
  EXPECT_EQ(time.time_of(at(3s)), at(11s));
  EXPECT_EQ(time.stamp_of(at(11s)), at(3s));
  EXPECT_EQ(time.stamp_of(at(9s)), at(9s));
  time.step(at(100s), at(20s));
  EXPECT_EQ(time.stamp_of(at(21s)), at(101s));
  EXPECT_EQ(time.stamp_of(at(19s)), at(11s));
}

class ClockStepTest : public testing::Test {
 protected:
  /// Plays everything up to `seconds` of the flight, stamped by a clock that is `clock_` ahead.
  void play(double seconds) {
    const auto end = Timestamp{from_seconds(seconds)};
    for (ImuSample sample : run_.imu(played_, end)) {
      const Timestamp truth = sample.stamp;
      sample.stamp += clock_;
      if (const auto pose = pipeline_.add_imu(sample)) {
        EXPECT_GE(pose->stamp, sample.stamp - kUnseen);  // two are accepted at once after a gap
        poses_.push_back(*pose);
        pipeline_.poll(pose->stamp);
      }
      while (run_.frame_stamp(next_frame_) <= truth) {
        TrackedFrame frame = run_.frame(next_frame_++);
        frame.stamp += clock_;
        pipeline_.add_frame(std::move(frame));
      }
      for (FrameOutput& frame : pipeline_.take_frames()) {
        frame.stamp -= clock_;
        frames_.push_back(std::move(frame));
      }
      pipeline_.take_answers();
    }
    played_ = end + Duration(1);
  }

  void set_clock(Duration by) {
    clock_ += by;
    const Timestamp next = run_.imu(played_, played_ + 1s).front().stamp;
    pipeline_.step_clock({.stamp = next + clock_, .unseen = kUnseen});
    ahead_ += max_imu_step(config_.odometry) + 1ms - kUnseen;
  }

  [[nodiscard]] double map_error(const FrameOutput& frame) const {
    return (frame.pose.T_map_body->p - run_.truth(frame.stamp).T_odom_body.p).norm();
  }
  static double map_sigma(const FrameOutput& frame) {
    return std::sqrt(frame.pose.covariance_map.bottomRightCorner<3, 3>().trace());
  }

  /// A step at 6 s is survived, whatever its size.
  void expect_recovery_after(Duration step) {
    play(6.0);
    EXPECT_EQ(frames_.back().pose.quality, Quality::kLocalized);
    const std::size_t before = frames_.size();
    set_clock(step);
    play(12.0);
    EXPECT_EQ(pipeline_.faults().at("clock_steps"), 1U);
    EXPECT_EQ(pipeline_.odometry().statistics().resets, 1U);
    ASSERT_EQ(localizer_.sessions.size(), 2U);
    EXPECT_EQ(localizer_.sessions.back().session, SessionNumber{8});
    for (std::size_t i = before + 1; i < frames_.size(); ++i) {
      const FrameOutput& frame = frames_[i];
      ASSERT_TRUE(frame.pose.T_map_body.has_value()) << second_of(frame.stamp);  // carried
      EXPECT_LT(map_error(frame), std::max(0.1, 3.0 * map_sigma(frame))) << second_of(frame.stamp);
      EXPECT_GT(frame.stamp, frames_[i - 1].stamp);
    }
    EXPECT_NE(frames_[before + 5].pose.quality, Quality::kLocalized);
    EXPECT_EQ(frames_.back().pose.quality, Quality::kLocalized);
    EXPECT_LT(map_error(frames_.back()), 0.05);
    EXPECT_LE(pipeline_.faults().at("refused_frame_not_newer"), 0U);
    EXPECT_LE(pipeline_.faults().at("refused_imu_not_newer"), 0U);
  }

  const SimulatedRun run_{noisy_flight()};
  const RobotPipeline::Config config_ = read_robot_pipeline_config(defaults());
  Duration ahead_{};  // of the estimators' time
  TruthfulLocalizer localizer_{
      [this](Timestamp time) { return run_.truth(time - ahead_).T_odom_body; }};
  SimulatedBackEnd back_end_{
      KeyframeWorker(run_.stereo(), run_.noise(), read_keyframe_worker_config(defaults()), {}),
      50ms};
  RobotPipeline pipeline_{{.id = "robot",
                           .calibration = ideal_cameras(run_.stereo()),
                           .imu_noise = run_.noise(),
                           .session = SessionNumber{7},
                           .T_map_body = run_.truth(run_.frame_stamp(0)).T_odom_body},
                          config_,
                          back_end_,
                          &localizer_};
  Duration clock_{};
  Timestamp played_;
  int next_frame_ = 0;
  std::vector<FrameOutput> frames_;
  std::vector<PoseEstimate> poses_;
};

TEST_F(ClockStepTest, BackByTenSecondsBeginsANewSessionWithThePoseCarried) {
  expect_recovery_after(-10s);
}

TEST_F(ClockStepTest, ForwardByAnHourBeginsANewSessionWithThePoseCarried) {
  expect_recovery_after(1h);
}

TEST_F(ClockStepTest, ByYearsBeforeAnythingHasStartedChangesNothing) {
  clock_ = -50 * 365 * 24h;
  ahead_ = clock_;
  pipeline_.step_clock({.stamp = Timestamp{clock_}, .unseen = 1s});
  play(6.0);
  EXPECT_EQ(frames_.back().pose.quality, Quality::kLocalized);
  EXPECT_EQ(poses_.back().stamp, Timestamp{6s} + clock_);
}

TEST_F(ClockStepTest, TwiceIsSurvivedTwice) {
  play(5.0);
  set_clock(-1h);
  play(9.0);
  set_clock(2h);
  play(14.0);
  EXPECT_EQ(localizer_.sessions.size(), 3U);
  EXPECT_EQ(poses_.back().stamp, Timestamp{14s} + clock_);
  EXPECT_EQ(frames_.back().pose.quality, Quality::kLocalized);
  EXPECT_LT(map_error(frames_.back()), 0.05);
}

// Without being told the pipeline takes it for a gap in which the robot may have gone anywhere.
class UnannouncedStep : public ClockStepTest, public testing::WithParamInterface<Duration> {};

TEST_P(UnannouncedStep, IsAGapAfterWhichTheRobotIsLostAndTracksAgain) {
  play(6.0);
  clock_ = GetParam();
  ahead_ = GetParam();
  play(12.0);
  EXPECT_EQ(pipeline_.faults().at("reset_imu_gap"), 1U);
  EXPECT_EQ(pipeline_.odometry().statistics().resets, 1U);
  EXPECT_EQ(localizer_.sessions.size(), 2U);
  EXPECT_EQ(pipeline_.odometry().phase(), VisualInertialOdometry::Phase::kTracking);
  EXPECT_EQ(poses_.back().stamp, Timestamp{12s} + clock_);
}

INSTANTIATE_TEST_SUITE_P(Durations, UnannouncedStep, testing::Values(3s, 30s, 300s, 1h, 24h * 365));

}  // namespace
}  // namespace fleetloc
