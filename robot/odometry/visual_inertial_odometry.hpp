#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "robot/inertial/imu_buffer.hpp"
#include "robot/odometry/back_end.hpp"
#include "robot/odometry/continuation.hpp"
#include "robot/odometry/front_end.hpp"
#include "robot/odometry/odometry_health.hpp"
#include "robot/odometry/outlier_tracks.hpp"
#include "robot/odometry/standstill.hpp"
#include "robot/vio/frame_estimator.hpp"
#include "robot/vio/initializer.hpp"
#include "shared/core/expected.hpp"
#include "shared/core/histogram.hpp"
#include "shared/model/camera_frame.hpp"
#include "shared/model/pose_estimate.hpp"

namespace fleetloc {

/// What the odometry made of one frame.
struct OdometryFrame {
  Timestamp stamp;
  int tracks = 0;                            ///< observations of the frame
  std::optional<OdometryEstimate> estimate;  ///< while it tracks
  bool keyframe = false;
  bool in_imu_gap = false;          ///< the IMU does not reach back to it: it was left out
  std::optional<ResetCause> reset;  ///< the odometry was reset at this frame
  Duration cpu{};
};

/// How an odometry began.
struct OdometryStart {
  Timestamp stamp;   ///< of the newest keyframe of the initialization
  Pose T_odom_body;  ///< at it
  /// Body at it relative to the body at the first frame of all; nothing if that motion was not
  /// observed.
  std::optional<Pose> T_first_newest;
  /// The dead-reckoned pose at its oldest keyframe, where it goes on; nothing: odom began anew.
  std::optional<PoseEstimate> continued;
};

/// The window after an optimization.
struct OdometryWindow {
  std::shared_ptr<const WindowEstimate> window;
  Submap submap;                       ///< robot, session and number are not set
  std::optional<OdometryStart> start;  ///< with the first window since the start or a reset
};

struct OdometryStatistics {
  std::uint64_t keyframes = 0;
  std::uint64_t windows = 0;  ///< optimized, those of odometries that had ended left out
  std::uint64_t corrections_applied = 0;  ///< constraints of the cloud that entered a window
  std::uint64_t corrections_ignored = 0;  ///< and that did not
  std::uint64_t resets = 0;
  Duration standstill{};  ///< for which the pose was held
  Histogram back_end_ms;  ///< processor time of each keyframe's job
};

/// Visual-inertial odometry: images and IMU in, T_odom_body of every frame and windows of keyframes
/// out. The window is optimized in the back end, beside the tracking.
///
/// Where the body stands still its pose is held: no keyframes, no drift; it may be dark meanwhile,
/// and people may pass. The motion that follows goes on from there.
///
/// Some bad images are bridged by inertial prediction. Where that is not enough (OdometryHealth) it
/// resets itself and is initialized again, in motion.
class VisualInertialOdometry {
 public:
  struct Config {
    FeatureTracker::Config tracking;
    Initializer::Config initializer;
    FrameEstimator::Config frame_estimator;
    OdometryHealth::Config health;
    StandstillDetector::Config standstill;
    Duration holds_without_place{};  ///< after a standstill of that long, see set_place_known()
  };

  enum class Phase {
    kWaiting,       ///< after a reset, for the back end to end its job for the odometry before
    kInitializing,  ///< frames are collected until they tell gravity and velocity
    kStarting,      ///< the first window is being optimized
    kTracking,      ///< every frame has a pose
  };

  /// @param back_end  must outlive the odometry
  VisualInertialOdometry(const StereoCalibration& calibration,
                         const ImuNoise& imu_noise,
                         const Config& config,
                         BackEnd& back_end,
                         CpuClock cpu_clock);

  /// Stamps increase. A gap that is too long to integrate across resets an odometry that runs.
  expected<void, ResetCause> add_imu(const ImuSample& sample);

  /// Stamps increase. The frame is tracked by track_next() once the IMU covers its stamp.
  void add_frame(CameraFrame frame) { pending_.push_back(std::move(frame)); }

  /// Whether nobody waits for keyframes, as for a first place in the map; at first somebody does.
  /// Then the pose is held only after some more seconds of a standstill: those that follow show
  /// nothing new.
  void set_place_known(bool known) { is_place_known_ = known; }

  /// Tracks the oldest frame that was added; nothing if the IMU does not reach it yet.
  std::optional<OdometryFrame> track_next();

  /// While there is no odometry after a reset: the pose of the frame tracked last, dead-reckoned.
  /// The next odometry goes on from it.
  void add_dead_reckoned(const PoseEstimate& pose);

  /// A correction of the cloud, for the next keyframe; a newer one replaces it.
  void add_correction(Correction correction) { correction_ = std::move(correction); }
  /// The place in the map that all corrections until now are of has been given up.
  void forget_corrections() {
    correction_.reset();
    forgets_corrections_ = true;
  }

  /// The window that the back end has finished, if it has one; or why that window reset the
  /// odometry.
  expected<std::optional<OdometryWindow>, ResetCause> take_window(Timestamp now);

  [[nodiscard]] Phase phase() const { return phase_; }
  [[nodiscard]] const OdometryStatistics& statistics() const { return statistics_; }
  /// Counts by kind: "imu_gaps", "frames_in_imu_gaps", "missing_images", "wrong_images",
  /// "vision_lost_frames", "vision_inconsistent_frames", "reset_..." by cause, and
  /// "initialization_..." and "submap_..." by why they failed.
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const;

 private:
  struct LatestKeyframe {
    KeyframeId id{};
    Timestamp stamp;
  };
  struct Held {
    OdometryEstimate estimate;
    Timestamp since;  // of the IMU's samples that are left out
  };

  OdometryFrame track(CameraFrame frame);
  OdometryFrame follow(CameraFrame frame);
  std::optional<OdometryFrame> stay(const CameraFrame& frame);
  std::optional<Timestamp> still_since(Timestamp stamp, const FrameEstimator::Result& result);
  void hold(const OdometryEstimate& estimate, Timestamp since);
  void initialize(const TrackedFrame& frame, std::optional<Timestamp> previous);
  void begin(Initialization initialization);
  OdometryFrame estimate(const TrackedFrame& frame);
  bool add_keyframe(const TrackedFrame& frame, const FrameEstimator::Result& result);
  ResetCause reset(ResetCause cause);
  OdometryWindow adopt(KeyframeResult result);

  Duration max_imu_step_;
  BackEnd& back_end_;
  CpuClock cpu_clock_;

  FrontEnd front_end_;
  Initializer initializer_;
  FrameEstimator frame_estimator_;
  OdometryHealth health_;
  StandstillDetector standstill_;
  Duration holds_without_place_;
  bool is_place_known_ = false;
  std::optional<Held> held_;  // while the body stands still
  ImuBuffer imu_;
  std::optional<Timestamp> last_imu_;
  std::deque<CameraFrame> pending_;  // the IMU does not cover them yet

  Phase phase_ = Phase::kInitializing;
  std::optional<OdometryStart> start_;            // until the first window is there
  std::shared_ptr<const WindowEstimate> window_;  // the latest; while tracking
  LatestKeyframe latest_keyframe_;
  bool back_end_busy_ = false;
  OutlierTracks outlier_tracks_;
  std::optional<Correction> correction_;
  bool forgets_corrections_ = false;  // with the next keyframe
  Continuation continuation_;
  OdometryStatistics statistics_;
  std::map<std::string, std::uint64_t> faults_ = {{"imu_gaps", 0},
                                                  {"frames_in_imu_gaps", 0},
                                                  {"vision_lost_frames", 0},
                                                  {"vision_inconsistent_frames", 0}};
};

/// Between two IMU samples: a longer step is a gap, across which nothing is integrated.
Duration max_imu_step(const VisualInertialOdometry::Config& config);

/// From robot.yaml.
VisualInertialOdometry::Config read_odometry_config(ConfigReader config);
KeyframeWorker::Config read_keyframe_worker_config(ConfigReader config);

}  // namespace fleetloc
