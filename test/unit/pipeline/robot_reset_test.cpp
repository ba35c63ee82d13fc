// What a robot does with bad input: on simulated tracks, with a localizer that knows the truth.
#include <algorithm>
#include <functional>
#include <limits>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/replay/simulated_back_end.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "test/simulated_setup.hpp"
#include "test/truthful_localizer.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {
namespace {

class RobotReset : public testing::Test {
 protected:
  explicit RobotReset(Duration back_end_time = std::chrono::milliseconds(50))
      : back_end_(KeyframeWorker(
                      run_.stereo(), run_.noise(), read_keyframe_worker_config(defaults()), {}),
                  back_end_time),
        pipeline_({.id = "robot",
                   .calibration = ideal_cameras(run_.stereo()),
                   .imu_noise = run_.noise(),
                   .session = SessionNumber{7},
                   .T_map_body = run_.truth(run_.frame_stamp(0)).T_odom_body},
                  read_robot_pipeline_config(defaults()),
                  back_end_,
                  &localizer_) {}

  /// Plays everything up to `seconds`, IMU and frames as `inject_imu_fault_` and `inject_fault_`
  /// leave them.
  void play(double seconds) {
    const auto end = Timestamp{from_seconds(seconds)};
    for (const ImuSample& sample : run_.imu(played_, end)) {
      if (const auto pose = pipeline_.add_imu(inject_imu_fault_(sample)))
        pipeline_.poll(pose->stamp);
      while (run_.frame_stamp(next_frame_) <= sample.stamp) {
        TrackedFrame frame = run_.frame(next_frame_++);
        inject_fault_(frame);
        if (!pipeline_.add_frame(std::move(frame))) ++rejected_;
        ++handed_in_;
      }
      for (FrameOutput& frame : pipeline_.take_frames()) frames_.push_back(std::move(frame));
      for (const LocalizationOutput& answer : pipeline_.take_answers()) {
        applied_ += answer.outcome ? 1 : 0;
      }
    }
    played_ = end + Duration(1);
  }

  [[nodiscard]] std::uint64_t resets() const { return pipeline_.odometry().statistics().resets; }

  /// Without IMU in [from, to).
  void cut_imu(double from, double to) {
    inject_imu_fault_ = [=](ImuSample sample) {
      const double t = second_of(sample.stamp);
      if (t >= from && t < to) {
        sample.specific_force.setConstant(std::numeric_limits<double>::quiet_NaN());
      }
      return sample;
    };
  }

  [[nodiscard]] double map_error(const FrameOutput& frame) const {
    return (frame.pose.T_map_body->p - run_.truth(frame.stamp).T_odom_body.p).norm();
  }
  static double map_sigma(const FrameOutput& frame) {
    return std::sqrt(frame.pose.covariance_map.bottomRightCorner<3, 3>().trace());
  }
  void expect_never_confidently_wrong() const {
    for (const FrameOutput& frame : frames_) {
      if (frame.pose.quality != Quality::kLocalized) continue;
      const double error = map_error(frame);
      EXPECT_FALSE(error > 0.5 && error > 3.0 * map_sigma(frame)) << second_of(frame.stamp);
    }
  }
  [[nodiscard]] const FrameOutput& frame_at(double seconds) const {
    return *std::ranges::find_if(
        frames_, [&](const FrameOutput& frame) { return second_of(frame.stamp) >= seconds; });
  }

  std::function<ImuSample(ImuSample)> inject_imu_fault_ = [](const ImuSample& sample) {
    return sample;
  };
  std::function<void(TrackedFrame&)> inject_fault_ = [](TrackedFrame&) {};
  const SimulatedRun run_{noisy_flight()};
  TruthfulLocalizer localizer_{[this](Timestamp stamp) { return run_.truth(stamp).T_odom_body; }};
  SimulatedBackEnd back_end_;
  RobotPipeline pipeline_;
  Timestamp played_;
  int next_frame_ = 0;
  std::size_t handed_in_ = 0;
  std::size_t rejected_ = 0;
  int applied_ = 0;
  std::vector<FrameOutput> frames_;
};

TEST_F(RobotReset, IsNotNeededForTwoSecondsWithoutFeatures) {
  inject_fault_ = [](TrackedFrame& frame) {
    const double t = second_of(frame.stamp);
    if (t > 6.0 && t < 8.0) frame.observations.clear();
  };
  play(12.0);
  EXPECT_EQ(resets(), 0U);
  EXPECT_EQ(pipeline_.faults().at("vision_lost_frames"), 39U);
  EXPECT_GT(map_sigma(frame_at(7.9)), 2.0 * map_sigma(frame_at(5.9)));
  EXPECT_LT(map_error(frame_at(7.9)), 3.0 * map_sigma(frame_at(7.9)));
  EXPECT_EQ(frames_.back().pose.quality, Quality::kLocalized);
  EXPECT_LT(map_error(frames_.back()), 0.05);
  expect_never_confidently_wrong();
}

TEST_F(RobotReset, IsNotNeededForAnImuGapThatCanBeBridged) {
  cut_imu(6.0, 6.2);
  play(10.0);
  EXPECT_EQ(resets(), 0U);
  EXPECT_EQ(pipeline_.faults().at("refused_imu_impossible"), 40U);
  EXPECT_LT(map_error(frames_.back()), 0.05);
  expect_never_confidently_wrong();
}

TEST_F(RobotReset, FollowsALongImuGapWithANewSessionThatStartsFromWhereTheRobotIs) {
  cut_imu(6.0, 7.0);
  play(12.0);
  EXPECT_EQ(resets(), 1U);
  EXPECT_EQ(pipeline_.faults().at("reset_imu_gap"), 1U);
  ASSERT_EQ(localizer_.sessions.size(), 2U);
  const RobotSession& session = localizer_.sessions.back();
  EXPECT_EQ(session.session, SessionNumber{8});
  EXPECT_EQ(localizer_.first_keyframes.back(), KeyframeId{0});
  // A second at unknown speed: a search from there would end anywhere.
  EXPECT_FALSE(session.start.has_value());
  EXPECT_EQ(pipeline_.faults().at("withheld_starts"), 1U);
  EXPECT_EQ(frame_at(7.9).pose.quality, Quality::kLost) << "nobody knows how far it was carried";
  for (const FrameOutput& frame : frames_) {
    const double t = second_of(frame.stamp);
    EXPECT_TRUE(t < 6.0 || t > 8.0 || frame.pose.quality != Quality::kLocalized) << t;
    EXPECT_TRUE(t < 3.0 || frame.pose.T_map_body.has_value()) << t;
  }
  EXPECT_LT(map_error(frame_at(7.9)), 3.0 * map_sigma(frame_at(7.9)));
  EXPECT_EQ(frames_.back().pose.quality, Quality::kLocalized);
  EXPECT_LT(map_error(frames_.back()), 0.05);
  expect_never_confidently_wrong();
}

TEST_F(RobotReset, FollowsTooLongADarknessAndEndsWhenItDoes) {
  inject_fault_ = [](TrackedFrame& frame) {
    const double t = second_of(frame.stamp);
    if (t > 6.0 && t < 11.0) frame.observations.clear();
  };
  play(16.0);
  EXPECT_EQ(resets(), 1U);
  EXPECT_EQ(pipeline_.faults().at("reset_vision_lost"), 1U);
  EXPECT_EQ(frame_at(10.5).pose.quality, Quality::kLost);
  EXPECT_LT(map_error(frame_at(10.5)), 3.0 * map_sigma(frame_at(10.5)));
  EXPECT_EQ(frames_.back().pose.quality, Quality::kLocalized);
  EXPECT_LT(map_error(frames_.back()), 0.05);
  // odom goes on: no jump beyond what dead reckoning was off.
  double largest_step = 0.0;
  for (std::size_t i = 1; i < frames_.size(); ++i) {
    if (frames_[i - 1].pose.quality == Quality::kInitializing) continue;
    const auto& [before, after] = std::pair(frames_[i - 1].pose, frames_[i].pose);
    largest_step = std::max(largest_step, (after.T_odom_body.p - before.T_odom_body.p).norm());
  }
  EXPECT_LT(largest_step, 0.5);
  expect_never_confidently_wrong();
}

TEST_F(RobotReset, KeepsTheStartPoseIfNoAnswerHasCome) {
  localizer_.answering = false;
  inject_fault_ = [](TrackedFrame& frame) {
    const double t = second_of(frame.stamp);
    if (t > 6.0 && t < 9.2) frame.observations.clear();
  };
  play(12.0);
  ASSERT_EQ(localizer_.sessions.size(), 2U);
  const auto& before = localizer_.sessions.front().start;
  const auto& after = localizer_.sessions.back().start;
  ASSERT_TRUE(before.has_value() && after.has_value());
  EXPECT_LT(local_coordinates(before->T_map_odom, after->T_map_odom).norm(), 1e-9);
  EXPECT_GT(after->covariance.trace(), before->covariance.trace() + 1e-4);
}

TEST_F(RobotReset, HasImagesThatShowAnotherMotionThanTheImuFeelsLeftOut) {
  TrackedFrame frozen;
  inject_fault_ = [&frozen](TrackedFrame& frame) {
    const double t = second_of(frame.stamp);
    if (t < 6.0) frozen = frame;
    if (t >= 6.0 && t < 8.0) frame.observations = frozen.observations;
  };
  play(12.0);
  EXPECT_GT(pipeline_.faults().at("vision_inconsistent_frames"), 30U);
  EXPECT_LT(map_error(frames_.back()), 0.1);
  expect_never_confidently_wrong();
}

TEST_F(RobotReset, GivesOneOutputForEveryFrameThatItDoesNotReject) {
  int count = 0;
  inject_fault_ = [&count, this](TrackedFrame& frame) {
    if (++count % 7 == 0) frame.stamp = run_.frame_stamp(next_frame_ - 2);  // doubled
    if (count % 11 == 0) frame.stamp -= std::chrono::seconds(1);
    if (count % 13 == 0) frame.stamp += std::chrono::hours(1);
  };
  cut_imu(6.0, 7.0);
  play(9.0);
  EXPECT_EQ(frames_.size() + rejected_, handed_in_);
  const auto faults = pipeline_.faults();
  EXPECT_EQ(rejected_,
            faults.at("refused_frame_not_newer") + faults.at("refused_frame_ahead_of_imu"));
  EXPECT_GT(faults.at("refused_frame_not_newer"), 20U);
}

TEST_F(RobotReset, TellsWhatAnotherLocalizerWouldBeginWithAsItIsNow) {
  const auto sigma_where_known = [this] {
    const MapOdomEstimate& start = *localizer_.updated_start;
    const Matrix6d A = adjoint(inverse(frames_.back().pose.T_odom_body));
    EXPECT_LT((start.p_odom - frames_.back().pose.T_odom_body.p).norm(), 1.0);
    return std::sqrt((A * start.covariance * A.transpose()).bottomRightCorner<3, 3>().trace());
  };
  play(6.0);
  EXPECT_GT(applied_, 0);
  EXPECT_EQ(localizer_.applied, applied_);
  ASSERT_TRUE(localizer_.updated_start.has_value());
  const Pose T_map_body = localizer_.updated_start->T_map_odom * frames_.back().pose.T_odom_body;
  const Pose truth = run_.truth(frames_.back().stamp).T_odom_body;
  EXPECT_LT((T_map_body.p - truth.p).norm(), 0.05);
  const double sigma_with_answers = sigma_where_known();
  localizer_.answering = false;
  play(12.0);
  EXPECT_GT(sigma_where_known(), 1.2 * sigma_with_answers);
}

class SlowRobotReset : public RobotReset {
 protected:
  SlowRobotReset() : RobotReset(std::chrono::milliseconds(400)) {}
};

TEST_F(SlowRobotReset, DropsTheResultThatBelongsToTheSessionBefore) {
  cut_imu(6.0, 6.7);  // with jobs of 0.4 s one is always on its way
  play(12.0);
  EXPECT_EQ(resets(), 1U);
  ASSERT_EQ(localizer_.sessions.size(), 2U);
  EXPECT_EQ(localizer_.first_keyframes.back(), KeyframeId{0});
  EXPECT_EQ(static_cast<std::uint64_t>(localizer_.submaps_of_session[0] +
                                       localizer_.submaps_of_session[1]),
            pipeline_.odometry().statistics().windows);
  EXPECT_GT(pipeline_.odometry().statistics().back_end_ms.count(),
            pipeline_.odometry().statistics().windows);  // one was dropped
  EXPECT_LT(map_error(frames_.back()), 0.1);
}

}  // namespace
}  // namespace fleetloc
