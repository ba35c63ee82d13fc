#include "robot/odometry/visual_inertial_odometry.hpp"

#include <gmock/gmock.h>

#include "test/simulated_setup.hpp"
#include "test/unit/vio/simulated_correction.hpp"

namespace fleetloc {
namespace {

using ::testing::ElementsAre;
using Phase = VisualInertialOdometry::Phase;

/// Does a job when the test says so.
class HeldBackEnd final : public BackEnd {
 public:
  explicit HeldBackEnd(KeyframeWorker worker) : worker_(std::move(worker)) {}

  void start(KeyframeJob job, Timestamp /*now*/) override {
    EXPECT_FALSE(job_.has_value());
    job_ = std::move(job);
  }
  std::optional<KeyframeResult> take(Timestamp /*now*/) override {
    if (is_held || !job_) return std::nullopt;
    const KeyframeJob job = *std::exchange(job_, std::nullopt);
    if (const auto* input = std::get_if<KeyframeInput>(&job)) keyframes.push_back(*input);
    return worker_.run(job);
  }

  bool is_held = false;
  std::vector<KeyframeInput> keyframes;  // done

 private:
  KeyframeWorker worker_;
  std::optional<KeyframeJob> job_;
};

class VisualInertialOdometryTest : public testing::Test {
 protected:
  /// Plays everything up to `seconds`, without IMU in [gap_from_, gap_to_) and without frames in
  /// [dark_from_, dark_to_).
  void play(double seconds) {
    const auto end = Timestamp{from_seconds(seconds)};
    for (const ImuSample& sample : run_.imu(played_, end)) {
      const double t = to_seconds(sample.stamp - Timestamp{});
      if (t >= gap_from_ && t < gap_to_) continue;
      if (const auto added = odometry_.add_imu(sample); !added) causes_.push_back(added.error());
      while (run_.frame_stamp(next_frame_) <= sample.stamp) {
        TrackedFrame frame = run_.frame(next_frame_++);
        if (t < dark_from_ || t >= dark_to_) odometry_.add_frame(std::move(frame));
      }
      while (auto frame = odometry_.track_next()) take(std::move(*frame));
      auto window = odometry_.take_window(sample.stamp);
      if (!window) causes_.push_back(window.error());
      if (window && *window && (*window)->start) starts_.push_back(*(*window)->start);
      if (window && *window) window_ = (*window)->window;
    }
    played_ = end + Duration(1);
  }
  void take(OdometryFrame frame) {
    if (frame.reset) causes_.push_back(*frame.reset);
    PoseEstimate carried;
    carried.stamp = frame.stamp;
    carried.quality = Quality::kDeadReckoning;
    carried.T_odom_body = run_.truth(frame.stamp).T_odom_body;
    odometry_.add_dead_reckoned(carried);
    frames_.push_back(std::move(frame));
  }
  [[nodiscard]] std::uint64_t resets() const { return odometry_.statistics().resets; }

  const SimulatedRun run_{noisy_flight()};
  HeldBackEnd back_end_{
      KeyframeWorker(run_.stereo(), run_.noise(), read_keyframe_worker_config(defaults()), {})};
  VisualInertialOdometry odometry_{
      ideal_cameras(run_.stereo()), run_.noise(), read_odometry_config(defaults()), back_end_, {}};
  double gap_from_ = 1e9;
  double gap_to_ = 1e9;
  double dark_from_ = 1e9;
  double dark_to_ = 1e9;
  Timestamp played_;
  int next_frame_ = 0;
  std::vector<OdometryFrame> frames_;
  std::vector<OdometryStart> starts_;
  std::shared_ptr<const WindowEstimate> window_;  // the latest
  std::vector<ResetCause> causes_;
};

TEST_F(VisualInertialOdometryTest, GivesAPoseToEveryFrameOnceTheFirstWindowIsThere) {
  EXPECT_EQ(odometry_.phase(), Phase::kInitializing);
  back_end_.is_held = true;
  play(3.0);
  EXPECT_EQ(odometry_.phase(), Phase::kStarting);
  EXPECT_FALSE(frames_.back().estimate.has_value());
  back_end_.is_held = false;
  play(3.1);
  EXPECT_EQ(odometry_.phase(), Phase::kTracking);
  ASSERT_EQ(starts_.size(), 1U);
  EXPECT_TRUE(starts_[0].T_first_newest.has_value());
  EXPECT_FALSE(starts_[0].continued.has_value());
  frames_.clear();
  play(6.0);
  EXPECT_GT(frames_.size(), 50U);
  for (const OdometryFrame& frame : frames_) EXPECT_TRUE(frame.estimate.has_value());
  EXPECT_TRUE(causes_.empty());
}

TEST_F(VisualInertialOdometryTest, CountsWhatItsWindowsTakeOfCorrections) {
  play(5.0);
  ASSERT_TRUE(window_);
  EXPECT_EQ(odometry_.statistics().corrections_applied, 0U);
  Correction correction = SimulatedCloud{}.correction(run_, *window_);
  correction.landmarks.push_back({.id = LandmarkId{4'000'000'000}});  // of no window
  const std::size_t all = correction.landmarks.size() + correction.relative_poses.size();
  odometry_.add_correction(std::move(correction));
  play(6.0);
  const OdometryStatistics& statistics = odometry_.statistics();
  EXPECT_GT(statistics.corrections_applied, 20U);
  EXPECT_GE(statistics.corrections_ignored, 1U);
  EXPECT_EQ(statistics.corrections_applied + statistics.corrections_ignored, all);
}

TEST_F(VisualInertialOdometryTest, ForgetsACorrectionThatIsOfAPlaceGivenUp) {
  play(5.0);
  ASSERT_TRUE(window_);
  odometry_.add_correction(SimulatedCloud{}.correction(run_, *window_));
  odometry_.forget_corrections();
  play(6.0);
  EXPECT_EQ(odometry_.statistics().corrections_applied, 0U);
  odometry_.add_correction(SimulatedCloud{}.correction(run_, *window_));
  play(7.0);
  EXPECT_GT(odometry_.statistics().corrections_applied, 0U);
}

TEST_F(VisualInertialOdometryTest, WaitsAfterAResetForTheJobOfTheOdometryBefore) {
  play(5.0);
  back_end_.is_held = true;
  play(5.5);  // a keyframe is in the back end by now
  const std::uint64_t windows = odometry_.statistics().windows;
  gap_from_ = 5.5;
  gap_to_ = 6.2;
  play(6.5);
  EXPECT_THAT(causes_, ElementsAre(ResetCause::kImuGap));
  EXPECT_EQ(odometry_.phase(), Phase::kWaiting);
  back_end_.is_held = false;
  play(6.6);
  EXPECT_EQ(odometry_.phase(), Phase::kInitializing);
  EXPECT_EQ(odometry_.statistics().windows, windows);  // it was of the odometry before
  play(9.0);
  EXPECT_EQ(odometry_.phase(), Phase::kTracking);
  EXPECT_EQ(resets(), 1U);
}

TEST_F(VisualInertialOdometryTest, GoesOnWhereItWasCarriedToAfterAReset) {
  gap_from_ = 5.0;
  gap_to_ = 5.7;
  play(9.0);
  ASSERT_EQ(starts_.size(), 2U);
  EXPECT_FALSE(starts_[1].T_first_newest.has_value());
  ASSERT_TRUE(starts_[1].continued.has_value());
  const Pose error = inverse(run_.truth(frames_.back().stamp).T_odom_body) *
                     frames_.back().estimate->state.T_odom_body;
  EXPECT_LT(error.p.norm(), 0.1);
}

TEST_F(VisualInertialOdometryTest, BeginsAnewWhenFramesComeBackAfterLongerThanItKeepsTheImu) {
  dark_from_ = 4.0;
  dark_to_ = 40.0;
  play(39.0);
  EXPECT_TRUE(causes_.empty());  // nothing has come that could be judged
  play(44.0);
  EXPECT_THAT(causes_, ElementsAre(ResetCause::kVisionLost));
  EXPECT_EQ(odometry_.phase(), Phase::kTracking);
}

TEST_F(VisualInertialOdometryTest, SaysOfFramesInAGapOfTheImuThatTheyWereLeftOut) {
  gap_from_ = 4.0;
  gap_to_ = 5.0;
  play(5.2);
  const auto left_out = std::ranges::count_if(frames_, &OdometryFrame::in_imu_gap);
  EXPECT_GT(left_out, 10);
  EXPECT_EQ(odometry_.faults().at("frames_in_imu_gaps"), static_cast<std::uint64_t>(left_out));
  EXPECT_EQ(odometry_.faults().at("imu_gaps"), 1U);
  EXPECT_EQ(odometry_.faults().at("reset_imu_gap"), 1U);
}

TEST_F(VisualInertialOdometryTest, SaysWhyItCouldNotBeInitialized) {
  for (const ImuSample& sample : run_.imu(Timestamp{}, Timestamp{from_seconds(3.0)})) {
    ImuSample heavy = sample;
    heavy.specific_force *= 1.3;
    ASSERT_TRUE(odometry_.add_imu(heavy).has_value());
    while (run_.frame_stamp(next_frame_) <= sample.stamp) {
      odometry_.add_frame(run_.frame(next_frame_++));
    }
    while (odometry_.track_next()) continue;
  }
  EXPECT_EQ(odometry_.phase(), Phase::kInitializing);
  EXPECT_GT(odometry_.faults().at("initialization_implausible_gravity"), 2U);
}

TEST_F(VisualInertialOdometryTest, GivesTheNewestCorrectionToTheNextKeyframeOnce) {
  play(4.0);
  back_end_.keyframes.clear();
  for (const std::uint32_t anchor : {7U, 8U}) {
    Correction correction;
    correction.anchor = KeyframeId{anchor};
    odometry_.add_correction(std::move(correction));
  }
  play(6.0);
  ASSERT_GT(back_end_.keyframes.size(), 2U);
  ASSERT_TRUE(back_end_.keyframes[0].correction.has_value());
  EXPECT_EQ(back_end_.keyframes[0].correction->anchor, KeyframeId{8});
  EXPECT_FALSE(back_end_.keyframes[1].correction.has_value());
}

TEST_F(VisualInertialOdometryTest, KeepsNoCorrectionOverAReset) {
  play(4.0);
  gap_from_ = 4.0;
  gap_to_ = 4.7;
  play(5.0);
  odometry_.add_correction({});
  back_end_.keyframes.clear();
  play(8.0);
  ASSERT_FALSE(back_end_.keyframes.empty());
  for (const KeyframeInput& keyframe : back_end_.keyframes) {
    EXPECT_FALSE(keyframe.correction.has_value());
  }
}

}  // namespace
}  // namespace fleetloc
