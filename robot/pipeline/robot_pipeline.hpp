#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "robot/fusion/pose_fusion.hpp"
#include "robot/inertial/imu_buffer.hpp"
#include "robot/pipeline/back_end.hpp"
#include "robot/pipeline/start_pose.hpp"
#include "robot/tracking/feature_tracker.hpp"
#include "robot/vio/frame_estimator.hpp"
#include "robot/vio/initializer.hpp"
#include "shared/model/map_localizer.hpp"
#include "shared/model/pose_estimate.hpp"
#include "shared/model/stereo_frame.hpp"

namespace fleetloc {

class ConfigReader;

/// A robot as it stands at the start of its program.
struct RobotSetup {
  RobotId id;
  StereoCalibration calibration;
  ImuNoise imu_noise;
  SessionNumber session{1};        ///< of the first start of the odometry; higher in later programs
  Timestamp program_start{};       ///< a later one replaces what the cloud knows of the robot
  std::optional<Pose> T_map_body;  ///< at the first image
  /// A control: ignore every answer after the first applied one, and all corrections.
  bool align_once = false;
};

/// What became of one stereo frame.
struct FrameOutput {
  Timestamp stamp;
  PoseEstimate pose;  ///< at the stamp, as known when the frame had been tracked
  int tracks = 0;     ///< observations of the frame
  bool keyframe = false;
  Duration tracking_cpu{};
};

/// What became of one answer of the cloud.
struct AnswerOutput {
  Answer answer;
  Timestamp arrival;
  bool applied = false;
  std::string_view reason;  ///< why not
};

/// The robot: images and IMU in, poses out, submaps to a MapLocalizer and its answers back.
/// It owns no threads and reads no clock; the back end runs where `BackEnd` lets it.
class RobotPipeline {
 public:
  struct Config {
    FeatureTracker::Config tracking;
    Initializer::Config initializer;
    FrameEstimator::Config frame_estimator;
    PoseFusion::Config fusion;
    StartUncertainty start;
  };

  /// @param localizer  may be null: odometry only. Both must outlive the pipeline.
  RobotPipeline(RobotSetup setup,
                const Config& config,
                BackEnd& back_end,
                MapLocalizer* localizer,
                CpuClock cpu_clock = {});

  /// The pose at the sample's stamp. A sample that is not newer than the last one is ignored.
  PoseEstimate add_imu(const ImuSample& sample);

  /// A frame is tracked as soon as the IMU covers its stamp; stamps increase.
  void add_images(StereoFrame frame);

  /// The same for a frame that has been tracked elsewhere: by a simulation, or by a recording.
  void add_tracks(TrackedFrame frame);

  /// Takes over what back end and cloud have finished. `now` is the robot's clock.
  void poll(Timestamp now);

  /// Each output is returned once, oldest first.
  std::vector<FrameOutput> take_frames() { return std::exchange(frames_, {}); }
  std::vector<AnswerOutput> take_answers() { return std::exchange(answers_, {}); }

  [[nodiscard]] std::uint64_t submaps_built() const { return submaps_built_; }
  [[nodiscard]] std::uint64_t keyframes() const { return next_keyframe_; }
  /// Landmarks and relative poses of the cloud that entered the window, and that did not.
  [[nodiscard]] std::uint64_t corrections_applied() const { return corrections_applied_; }
  [[nodiscard]] std::uint64_t corrections_ignored() const { return corrections_ignored_; }
  [[nodiscard]] std::uint64_t imu_samples() const { return imu_samples_; }
  [[nodiscard]] std::uint64_t refused_imu_samples() const { return refused_imu_samples_; }
  [[nodiscard]] Duration fusion_cpu() const { return fusion_cpu_; }  ///< of add_imu
  [[nodiscard]] const std::vector<Duration>& back_end_cpu() const { return back_end_cpu_; }

 private:
  using Frame = std::variant<StereoFrame, TrackedFrame>;
  void add_frame(Frame frame);
  void process_pending();
  TrackedFrame tracked(Frame frame);
  FrameOutput take_frame(Frame frame);
  void initialize(const TrackedFrame& frame);
  bool estimate(const TrackedFrame& frame);
  void take_back_end(Timestamp now);
  void fuse_first_window();
  void take_cloud(Timestamp now);
  void start_session(Timestamp now);
  [[nodiscard]] Eigen::Quaterniond predicted_rotation(Timestamp stamp) const;
  [[nodiscard]] StartPose start_pose(const Pose& T_map_body) const;

  RobotSetup setup_;
  Config config_;
  RectifiedStereo stereo_;
  BackEnd& back_end_;
  MapLocalizer* localizer_;
  CpuClock cpu_clock_;

  FeatureTracker tracker_;
  Initializer initializer_;
  FrameEstimator frame_estimator_;
  std::unique_ptr<PoseFusion> fusion_;
  ImuBuffer imu_;

  std::deque<Frame> pending_;
  std::optional<Timestamp> first_frame_;
  std::optional<Timestamp> previous_frame_;
  Timestamp newest_keyframe_;
  std::uint32_t next_keyframe_ = 0;
  bool back_end_busy_ = false;
  bool aligned_ = false;
  std::optional<Initialization> initialization_;  // once it is found
  std::shared_ptr<const WindowEstimate> window_;  // the latest
  std::vector<FrameOutput> frames_;
  std::vector<AnswerOutput> answers_;
  std::vector<Duration> back_end_cpu_;
  std::uint64_t submaps_built_ = 0;
  std::uint64_t corrections_applied_ = 0;
  std::uint64_t corrections_ignored_ = 0;
  std::uint64_t imu_samples_ = 0;
  std::uint64_t refused_imu_samples_ = 0;
  Duration fusion_cpu_{};
};

RobotPipeline::Config read_robot_pipeline_config(ConfigReader config);
KeyframeWorker::Config read_keyframe_worker_config(ConfigReader config);

}  // namespace fleetloc
