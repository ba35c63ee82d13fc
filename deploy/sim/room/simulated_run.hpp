#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "deploy/sim/room/room.hpp"
#include "deploy/sim/room/room_trajectory.hpp"
#include "shared/core/time.hpp"
#include "shared/model/camera.hpp"
#include "shared/model/inertial.hpp"
#include "shared/model/observation.hpp"

namespace fleetloc {

/// A robot that flies a smooth closed curve in a furnished room, for tests: exact truth, and
/// measurements whose noise sources can be switched on one by one.
class SimulatedRun {
 public:
  struct Config {
    std::uint64_t seed = 1;
    double rest_s = 0.0;          ///< stands still that long before it moves (smoothly)
    RoomTrajectory::Stop stop{};  ///< and once more on its way
    double imu_rate_hz = 200.0;
    double frame_rate_hz = 20.0;
    bool imu_white_noise = false;
    bool imu_bias_walk = false;
    ImuBias initial_bias;          ///< true bias at time zero
    double pixel_sigma = 0.0;      ///< noise of u_left, v and disparity [px]
    double outlier_share = 0.0;    ///< of observations, uniformly displaced by up to 50 px
    double speed = 1.0;            ///< typical [m/s]
    int landmarks = 3000;          ///< on the surfaces of the room
    int features_per_frame = 150;  ///< at most; tracks stay as long as they are visible
  };
  explicit SimulatedRun(const Config& config);

  [[nodiscard]] const RectifiedStereo& stereo() const;
  [[nodiscard]] const ImuNoise& noise() const;  ///< densities that the switches above apply

  /// In the room's frame, z up. The bias is the true one. Times count from Timestamp{}.
  [[nodiscard]] NavState truth(Timestamp stamp) const;

  /// After which, at full speed, the motion repeats.
  [[nodiscard]] double round_s() const { return trajectory_.round_s(); }

  /// Samples at stamps of [from, to]; the same stamp gives the same sample in every call.
  [[nodiscard]] std::vector<ImuSample> imu(Timestamp from, Timestamp to) const;

  /// Frames count from zero; frame(i) is the same in every call order.
  [[nodiscard]] TrackedFrame frame(int index) const;
  [[nodiscard]] Timestamp frame_stamp(int index) const;

  /// In the room's frame. Ids name tracks: a landmark that left the view and came back has a new
  /// one. Only for ids that frame() has returned; std::out_of_range for others.
  [[nodiscard]] Eigen::Vector3d landmark(LandmarkId id) const;

  /// Points on the surfaces of the room, about one per `spacing_m` squared, without noise.
  [[nodiscard]] std::vector<Eigen::Vector3d> surface_points(double spacing_m) const;

 private:
  struct Track {
    LandmarkId id;
    std::size_t landmark;  ///< index of landmarks_
  };
  [[nodiscard]] ImuBias bias_at(Timestamp stamp) const;
  [[nodiscard]] ImuSample imu_sample(std::int64_t index) const;
  [[nodiscard]] const std::vector<Track>& tracks_of_frame(int index) const;
  [[nodiscard]] std::vector<Track> next_tracks(int index) const;
  [[nodiscard]] StereoObservation observed(const Track& track,
                                           int index,
                                           const Pose& T_cam0_room) const;

  Config config_;
  ImuNoise noise_;
  RectifiedStereo stereo_;
  RoomTrajectory trajectory_;
  Room room_;
  std::vector<Eigen::Vector3d> landmarks_;
  // Histories, extended when a later time is asked for: one run is for one thread.
  mutable std::vector<ImuBias> walked_bias_;        ///< by index of the IMU sample
  mutable std::vector<std::vector<Track>> tracks_;  ///< by frame, increasing by id
  mutable std::vector<std::size_t> landmark_of_id_;
};

}  // namespace fleetloc
