#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

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
    double rest_s = 0.0;  ///< stands still that long before it moves (smoothly)
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

  /// Samples at stamps of [from, to]; the same stamp gives the same sample in every call.
  [[nodiscard]] std::vector<ImuSample> imu(Timestamp from, Timestamp to) const;

  /// Frames count from zero; frame(i) is the same in every call order.
  [[nodiscard]] TrackedFrame frame(int index) const;
  [[nodiscard]] Timestamp frame_stamp(int index) const;

  [[nodiscard]] Eigen::Vector3d landmark(LandmarkId id) const;  ///< in the room's frame

  /// Points on the surfaces of the room, about one per `spacing_m` squared, without noise.
  [[nodiscard]] std::vector<Eigen::Vector3d> surface_points(double spacing_m) const;
};

}  // namespace fleetloc
