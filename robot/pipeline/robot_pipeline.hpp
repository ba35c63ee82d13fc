#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "robot/fusion/pose_fusion.hpp"
#include "robot/odometry/visual_inertial_odometry.hpp"
#include "robot/pipeline/continuous_time.hpp"
#include "robot/pipeline/input_validator.hpp"
#include "robot/pipeline/session_start.hpp"
#include "robot/sensors/clock_step.hpp"
#include "robot/sensors/given_pose.hpp"
#include "shared/core/expected.hpp"
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
  SessionNumber session{
      1};  ///< of the first start of the odometry; each reset and placement adds one
  Timestamp program_start{};       ///< a later one replaces the robot's session in the cloud
  std::optional<Pose> T_map_body;  ///< at the first image
  std::optional<StartRegion> region = {};  ///< at the first image; not beside a pose
};

/// Result of one stereo frame.
struct FrameOutput {
  Timestamp stamp;
  PoseEstimate pose;  ///< at the stamp, as known when the frame had been tracked
  int tracks = 0;     ///< observations of the frame
  bool keyframe = false;
  std::uint64_t resets = 0;  ///< of the odometry so far
  Duration tracking_cpu{};
};

/// Result of one answer of the cloud.
struct LocalizationOutput {
  LocalizationResult answer;
  Timestamp arrival;
  AnswerOutcome outcome;
  /// Of the answer's pose from the one known before it, at its stamp, tangent of T_map_body;
  /// nothing if none was.
  std::optional<Vector6d> innovation;
};

/// The robot: images and IMU in, poses out; submaps to a MapLocalizer, answers back.
/// It owns no threads and reads no clock; the back end runs where `BackEnd` lets it.
///
/// After a reset of the odometry a new session begins as soon as it has been initialized again.
/// Poses are dead-reckoned meanwhile, and the new odom continues from them.
class RobotPipeline {
 public:
  struct Config {
    VisualInertialOdometry::Config odometry;
    PoseFusion::Config fusion;
    StartUncertainty start;
  };

  /// @param localizer  may be null: odometry only. Both must outlive the pipeline.
  RobotPipeline(RobotSetup setup,
                const Config& config,
                BackEnd& back_end,
                MapLocalizer* localizer,
                CpuClock cpu_clock = {});

  /// The pose at the sample's stamp.
  expected<PoseEstimate, InputRejection> add_imu(const ImuSample& sample);

  /// Images, or tracks of a simulation or a recording. Each frame that is accepted gives one
  /// FrameOutput, as soon as the IMU covers its stamp. A missing image, or one not of the
  /// calibrated size, is ignored.
  expected<void, InputRejection> add_frame(CameraFrame frame);

  /// Somebody tells where the robot is, at any time, also if it had a pose in the map: that and its
  /// answers are forgotten, and a new session of the cloud starts from here, with the keyframes so
  /// far. The odometry goes on.
  void place(const GivenPose& given);

  /// The clock of the sensors was set. The odometry is reset, and a new session goes on from the
  /// pose dead-reckoned over the time that was not seen, at least the shortest gap that resets it.
  /// Outputs have stamps of the new clock from then on; without a step the clock may not go back.
  void step_clock(const ClockStep& step);

  /// Collects results of the back end and answers of the cloud.
  /// @param stamp  the time of the robot's clock
  void poll(Timestamp stamp);

  /// Each output is returned once, oldest first.
  std::vector<FrameOutput> take_frames() { return std::exchange(frames_, {}); }
  std::vector<LocalizationOutput> take_answers() { return std::exchange(answers_, {}); }

  [[nodiscard]] const VisualInertialOdometry& odometry() const { return odometry_; }
  [[nodiscard]] std::uint64_t imu_samples() const { return imu_samples_; }
  [[nodiscard]] Duration fusion_cpu() const { return fusion_cpu_; }  ///< of its IMU samples
  [[nodiscard]] LinkTraffic traffic() const;  ///< of its localizer; without one there is none
  /// Counts of input faults and of their effects, by kind: those of the odometry, "clock_steps",
  /// "placements", "refused_..." by InputRejection, "unfused_..." (odometry) by FusionRejection,
  /// and by NoStart.
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const;

 private:
  void predict(const ImuSample& sample);
  void track_frames();
  FrameOutput fuse(const OdometryFrame& frame);
  void fuse(const OdometryEstimate& estimate);
  [[nodiscard]] PoseEstimate pose_at(Timestamp stamp) const;
  [[nodiscard]] PoseEstimate with_stamp(PoseEstimate pose) const;
  void take_window(Timestamp now);
  void begin_odometry(const OdometryWindow& window);
  void keep_region(const OdometryStart& begin);
  void begin_session(const OdometryWindow& window, Timestamp now);
  [[nodiscard]] RobotSession announced(const std::optional<MapOdomEstimate>& start) const;
  void fuse_answers(Timestamp now);
  [[nodiscard]] std::optional<Vector6d> innovation_of(const LocalizationResult& answer) const;
  [[nodiscard]] std::optional<MapOdomEstimate> start_from_answers(const Pose& T_odom_body) const;
  [[nodiscard]] SessionNumber session() const;

  RobotSetup setup_;
  MapLocalizer* localizer_;
  CpuClock cpu_clock_;

  Duration max_imu_step_;
  ContinuousTime time_;  // of all that is below
  std::optional<Timestamp> last_imu_;
  InputValidator input_validator_;
  VisualInertialOdometry odometry_;
  std::unique_ptr<PoseFusion> fusion_;
  SessionStart session_start_;
  std::optional<StartRegion> region_;  // as long as nothing more is known

  PoseEstimate latest_pose_;  // at the newest IMU sample
  std::vector<FrameOutput> frames_;
  std::vector<LocalizationOutput> answers_;
  std::uint64_t imu_samples_ = 0;
  std::uint32_t placements_ = 0;  // with a session of their own
  std::map<std::string, std::uint64_t> faults_ = {{"withheld_starts", 0}};
  Duration fusion_cpu_{};
};

RobotPipeline::Config read_robot_pipeline_config(ConfigReader config);

/// The part of the configuration that says how uncertain the start pose is.
/// @param text  "m deg" of position and heading. Throws std::invalid_argument.
ConfigReader start_sigma_config(const std::string& text);

/// @param text  a name, or "x y radius" [m]. Throws std::invalid_argument.
StartRegion start_region(const std::string& text);

}  // namespace fleetloc
