#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "robot/fusion/pose_fusion.hpp"
#include "robot/inertial/imu_buffer.hpp"
#include "robot/pipeline/back_end.hpp"
#include "robot/pipeline/input_validator.hpp"
#include "robot/pipeline/map_odom_estimate.hpp"
#include "robot/pipeline/odometry_health.hpp"
#include "robot/tracking/feature_tracker.hpp"
#include "robot/vio/frame_estimator.hpp"
#include "robot/vio/initializer.hpp"
#include "shared/core/histogram.hpp"
#include "shared/model/camera_frame.hpp"
#include "shared/model/map_localizer.hpp"
#include "shared/model/pose_estimate.hpp"

namespace fleetloc {

class ConfigReader;

/// What is known of a robot at the start of its program.
struct RobotSetup {
  RobotId id;
  StereoCalibration calibration;
  ImuNoise imu_noise;
  SessionNumber session{1};        ///< of the first start of the odometry; each reset adds one
  Timestamp program_start{};       ///< a later one replaces the robot's session in the cloud
  std::optional<Pose> T_map_body;  ///< at the first image
  /// Control experiment: ignore every answer after the first applied one, and all corrections.
  bool align_once = false;
};

/// Result of one stereo frame.
struct FrameOutput {
  Timestamp stamp;
  PoseEstimate pose;         ///< at the stamp, as known when the frame had been tracked
  std::string_view refused;  ///< why it was rejected and has no pose; empty: it was not
  int tracks = 0;            ///< observations of the frame
  bool keyframe = false;
  std::uint64_t resets = 0;  ///< of the odometry so far
  Duration tracking_cpu{};
};

/// Result of one answer of the cloud.
struct LocalizationOutput {
  LocalizationResult answer;
  Timestamp arrival;
  bool applied = false;
  std::string_view reason;  ///< why not
};

/// The robot: images and IMU in, poses out; submaps to a MapLocalizer, answers back.
/// It owns no threads and reads no clock; the back end runs where `BackEnd` lets it.
///
/// Some bad images are bridged by inertial prediction. Where that is not enough (OdometryHealth)
/// the odometry is reset: a new session begins as soon as it has been initialized again, in motion.
/// Poses are dead-reckoned meanwhile, and the new odom continues from them.
class RobotPipeline {
 public:
  struct Config {
    FeatureTracker::Config tracking;
    Initializer::Config initializer;
    FrameEstimator::Config frame_estimator;
    OdometryHealth::Config health;
    PoseFusion::Config fusion;
    StartUncertainty start;
  };

  /// @param localizer  may be null: odometry only. Both must outlive the pipeline.
  RobotPipeline(RobotSetup setup,
                const Config& config,
                BackEnd& back_end,
                MapLocalizer* localizer,
                CpuClock cpu_clock = {});

  /// The pose at the sample's stamp; nothing if the sample is refused, or has to be confirmed by
  /// the next one (InputValidator).
  std::optional<PoseEstimate> add_imu(const ImuSample& sample);

  /// A frame is tracked as soon as the IMU covers its stamp. A missing image, or one not of the
  /// calibrated size, is ignored. Each frame gives one FrameOutput.
  void add_images(StereoFrame frame);

  /// The same with tracks from a simulation or a recording instead of images.
  void add_tracks(TrackedFrame frame);

  /// Images or tracks.
  void add_frame(CameraFrame frame);

  /// Collects results of the back end and answers of the cloud. `now` is the robot's clock.
  void poll(Timestamp now);

  /// Each output is returned once, oldest first.
  std::vector<FrameOutput> take_frames() { return std::exchange(frames_, {}); }
  std::vector<LocalizationOutput> take_answers() { return std::exchange(answers_, {}); }

  [[nodiscard]] std::uint64_t submaps_built() const { return submaps_built_; }
  [[nodiscard]] std::uint64_t keyframes() const { return keyframes_; }
  /// Constraints of the cloud (e_pp, e_rt) that entered the window, and that did not.
  [[nodiscard]] std::uint64_t corrections_applied() const { return corrections_applied_; }
  [[nodiscard]] std::uint64_t corrections_ignored() const { return corrections_ignored_; }
  [[nodiscard]] std::uint64_t imu_samples() const { return imu_samples_; }
  [[nodiscard]] std::uint64_t resets() const { return resets_; }
  /// Counts of input faults and of their effects, by kind: "refused_...", "missing_images",
  /// "wrong_images", "vision_lost_frames", "vision_inconsistent_frames" and others, "reset_..." by
  /// cause.
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const;
  [[nodiscard]] Duration fusion_cpu() const { return fusion_cpu_; }  ///< of add_imu
  [[nodiscard]] const Histogram& back_end_ms() const { return back_end_ms_; }

 private:
  void handle_imu(const ImuSample& sample);
  void handle_pending();
  TrackedFrame tracked(CameraFrame frame);
  void check_image(cv::Mat& image, const Camera& camera);
  FrameOutput handle_frame(CameraFrame frame);
  FrameOutput skip_frame(Timestamp stamp);
  [[nodiscard]] PoseEstimate pose_at(Timestamp stamp) const;
  void initialize(const TrackedFrame& frame);
  bool estimate(const TrackedFrame& frame);
  void remember_outliers(const std::vector<LandmarkId>& outliers, const TrackedFrame& frame);
  void reset(ResetCause cause);
  void poll_back_end(Timestamp now);
  void fuse_first_window();
  void poll_cloud(Timestamp now);
  void start_session(Timestamp now);
  [[nodiscard]] Eigen::Quaterniond predicted_rotation(Timestamp stamp) const;
  [[nodiscard]] MapOdomEstimate start_from_initial_pose(const Pose& T_map_body_first) const;
  [[nodiscard]] std::optional<MapOdomEstimate> current_start() const;
  [[nodiscard]] bool is_usable(const MapOdomEstimate& start) const;

  RobotSetup setup_;
  Config config_;
  RectifiedStereo stereo_;
  BackEnd& back_end_;
  MapLocalizer* localizer_;
  CpuClock cpu_clock_;

  InputValidator input_validator_;
  FeatureTracker tracker_;
  Initializer initializer_;
  FrameEstimator frame_estimator_;
  OdometryHealth health_;
  std::unique_ptr<PoseFusion> fusion_;
  ImuBuffer imu_;

  std::deque<CameraFrame> pending_;
  std::optional<Timestamp> first_frame_;
  std::optional<Timestamp> previous_frame_;
  PoseEstimate latest_pose_;  // at the newest IMU sample
  Timestamp newest_keyframe_;
  std::set<LandmarkId> outlier_tracks_;  // of those that are still tracked
  std::uint32_t next_keyframe_ = 0;
  bool back_end_busy_ = false;
  bool discard_result_ = false;  // the job in the back end belongs to a session that has ended
  bool aligned_ = false;
  std::optional<Initialization> initialization_;     // once it is found
  std::shared_ptr<const WindowEstimate> window_;     // the latest
  std::map<Timestamp, PoseEstimate> dead_reckoned_;  // of the frames since a reset
  std::optional<PoseEstimate> continued_;  // dead-reckoned, at the oldest keyframe of a new start
  std::optional<MapOdomEstimate> start_;   // of the session
  std::vector<FrameOutput> frames_;
  std::vector<LocalizationOutput> answers_;
  Histogram back_end_ms_;
  std::uint64_t submaps_built_ = 0;
  std::uint64_t corrections_applied_ = 0;
  std::uint64_t corrections_ignored_ = 0;
  std::uint64_t keyframes_ = 0;
  std::uint64_t imu_samples_ = 0;
  std::uint64_t resets_ = 0;
  std::map<std::string, std::uint64_t> faults_ = {{"imu_gaps", 0},
                                                  {"frames_in_imu_gaps", 0},
                                                  {"missing_images", 0},
                                                  {"wrong_images", 0},
                                                  {"vision_lost_frames", 0},
                                                  {"vision_inconsistent_frames", 0},
                                                  {"withheld_starts", 0}};
  Duration fusion_cpu_{};
};

RobotPipeline::Config read_robot_pipeline_config(ConfigReader config);
KeyframeWorker::Config read_keyframe_worker_config(ConfigReader config);

}  // namespace fleetloc
