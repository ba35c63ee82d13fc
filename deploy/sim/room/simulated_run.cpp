#include "deploy/sim/room/simulated_run.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "shared/core/counter_random.hpp"

namespace fleetloc {
namespace {

// Streams of random numbers; each noise source has one, so switching one leaves the others alone.
enum Stream : std::uint64_t {
  kPlaces,
  kGyroscopeNoise,
  kAccelerometerNoise,
  kGyroscopeWalk,
  kAccelerometerWalk,
  kPixelNoise,
  kOutliers,
};

// Of the ADIS16448, as in EuRoC's sensor.yaml.
constexpr ImuNoise kNoise{1.6968e-4, 1.9393e-5, 2.0e-3, 3.0e-3};

constexpr double kHalfWidth = 376.0;      // of the image about its center [px]
constexpr double kHalfHeight = 240.0;     // [px]
constexpr double kNearest = 0.5;          // [m]
constexpr double kFarthest = 15.0;        // [m]
constexpr double kFewestDisparity = 0.1;  // with less the right camera has no observation [px]
constexpr double kOutlierReach = 50.0;    // [px]
constexpr int kFramesAhead = 20;  // new tracks are preferred that will still be visible then

RectifiedStereo make_stereo() {
  RectifiedStereo stereo;
  stereo.focal_px = 458.0;
  stereo.center_px.setConstant(0.5 * kRectifiedSize);
  stereo.baseline_m = 0.11;
  Eigen::Matrix3d R;             // EuRoC's cam0, rounded
  R << 0.0149, -0.9999, 0.0041,  //
      0.9996, 0.0150, 0.0257,    //
      -0.0258, 0.0038, 0.9997;
  stereo.T_body_cam0 = {Eigen::Quaterniond(R).normalized(), {-0.0216, -0.0647, 0.0098}};
  return stereo;
}

Timestamp stamp_of(std::int64_t index, double rate_hz) {
  return Timestamp{Duration{std::llround(static_cast<double>(index) * 1e9 / rate_hz)}};
}

double seconds(Timestamp stamp) {
  return to_seconds(stamp.time_since_epoch());
}

bool is_in_image(double u, double v, const RectifiedStereo& stereo) {
  return std::abs(u - stereo.center_px.x()) < kHalfWidth &&
         std::abs(v - stereo.center_px.y()) < kHalfHeight;
}

bool is_in_view(const Eigen::Vector3d& p_cam0, const RectifiedStereo& stereo) {
  const double range = p_cam0.norm();
  if (p_cam0.z() < 0.1 || range < kNearest || range > kFarthest) {
    return false;
  }
  const Eigen::Vector3d pixel = project(stereo, p_cam0);
  return is_in_image(pixel[0], pixel[1], stereo);
}

// Visible landmarks at one pose of the camera.
class View {
 public:
  View(const Pose& T_room_body, const RectifiedStereo& stereo, const Room& room)
      : stereo_(stereo), room_(room), T_room_cam0_(T_room_body * stereo.T_body_cam0) {}

  [[nodiscard]] bool sees(const Eigen::Vector3d& p_room) const {
    return is_in_view(T_cam0_room_ * p_room, stereo_) && room_.is_in_sight(T_room_cam0_.p, p_room);
  }

 private:
  const RectifiedStereo& stereo_;
  const Room& room_;
  Pose T_room_cam0_;
  Pose T_cam0_room_ = inverse(T_room_cam0_);
};

}  // namespace

SimulatedRun::SimulatedRun(const Config& config)
    : config_(config),
      noise_(kNoise),
      stereo_(make_stereo()),
      trajectory_(config.rest_s, config.speed, config.stop),
      landmarks_(
          room_.random_surface_points(config.landmarks, CounterRandom(config.seed, kPlaces))),
      walked_bias_{config.initial_bias} {
  assert(config.imu_rate_hz > 0.0 && config.frame_rate_hz > 0.0 && config.speed > 0.0);
}

const RectifiedStereo& SimulatedRun::stereo() const {
  return stereo_;
}

const ImuNoise& SimulatedRun::noise() const {
  return noise_;
}

NavState SimulatedRun::truth(Timestamp stamp) const {
  const Motion motion = trajectory_.at(seconds(stamp));
  return {motion.T_room_body, motion.v_room, bias_at(stamp)};
}

// The walk steps at the samples and is linear between them; before time zero it stands still.
ImuBias SimulatedRun::bias_at(Timestamp stamp) const {
  if (!config_.imu_bias_walk || stamp <= Timestamp{}) {
    return config_.initial_bias;
  }
  const double place = seconds(stamp) * config_.imu_rate_hz;
  const auto index = static_cast<std::size_t>(place);
  const CounterRandom gyroscope(config_.seed, kGyroscopeWalk);
  const CounterRandom accelerometer(config_.seed, kAccelerometerWalk);
  const double root_dt = 1.0 / std::sqrt(config_.imu_rate_hz);
  while (walked_bias_.size() < index + 2) {
    const std::uint64_t step = walked_bias_.size();
    const ImuBias& last = walked_bias_.back();
    walked_bias_.push_back(
        {last.gyroscope + kNoise.gyroscope_random_walk * root_dt * gyroscope.normal3(step),
         last.accelerometer +
             kNoise.accelerometer_random_walk * root_dt * accelerometer.normal3(step)});
  }
  const ImuBias& before = walked_bias_[index];
  const ImuBias& after = walked_bias_[index + 1];
  const double share = place - static_cast<double>(index);
  return {before.gyroscope + share * (after.gyroscope - before.gyroscope),
          before.accelerometer + share * (after.accelerometer - before.accelerometer)};
}

ImuSample SimulatedRun::imu_sample(std::int64_t index) const {
  const Timestamp stamp = stamp_of(index, config_.imu_rate_hz);
  const Motion motion = trajectory_.at(seconds(stamp));
  const ImuBias bias = bias_at(stamp);
  ImuSample sample;
  sample.stamp = stamp;
  sample.angular_velocity = motion.angular_velocity + bias.gyroscope;
  sample.specific_force =
      motion.T_room_body.R.conjugate() * (motion.a_room - kGravity) + bias.accelerometer;
  if (config_.imu_white_noise) {
    const double root_rate = std::sqrt(config_.imu_rate_hz);
    const auto counter = static_cast<std::uint64_t>(index);
    sample.angular_velocity += kNoise.gyroscope_noise_density * root_rate *
                               CounterRandom(config_.seed, kGyroscopeNoise).normal3(counter);
    sample.specific_force += kNoise.accelerometer_noise_density * root_rate *
                             CounterRandom(config_.seed, kAccelerometerNoise).normal3(counter);
  }
  return sample;
}

std::vector<ImuSample> SimulatedRun::imu(Timestamp from, Timestamp to) const {
  auto index = static_cast<std::int64_t>(std::floor(seconds(from) * config_.imu_rate_hz)) - 1;
  while (stamp_of(index, config_.imu_rate_hz) < from) {
    ++index;
  }
  std::vector<ImuSample> samples;
  for (; stamp_of(index, config_.imu_rate_hz) <= to; ++index) {
    samples.push_back(imu_sample(index));
  }
  return samples;
}

Timestamp SimulatedRun::frame_stamp(int index) const {
  return stamp_of(index, config_.frame_rate_hz);
}

TrackedFrame SimulatedRun::frame(int index) const {
  assert(index >= 0);
  TrackedFrame frame;
  frame.stamp = frame_stamp(index);
  const Pose T_room_body = trajectory_.at(seconds(frame.stamp)).T_room_body;
  const Pose T_cam0_room = inverse(T_room_body * stereo_.T_body_cam0);
  for (const Track& track : tracks_of_frame(index)) {
    frame.observations.push_back(observed(track, index, T_cam0_room));
  }
  return frame;
}

StereoObservation SimulatedRun::observed(const Track& track,
                                         int index,
                                         const Pose& T_cam0_room) const {
  Eigen::Vector3d pixel = project(stereo_, T_cam0_room * landmarks_[track.landmark]);
  const bool is_right = is_in_image(pixel[2], pixel[1], stereo_);
  pixel[2] = pixel[0] - pixel[2];

  // One counter per observation: its frame and its id.
  const std::uint64_t counter =
      (static_cast<std::uint64_t>(index) << 32U) | static_cast<std::uint64_t>(track.id);
  pixel += config_.pixel_sigma * CounterRandom(config_.seed, kPixelNoise).normal3(counter);
  const CounterRandom outliers(config_.seed, kOutliers);
  if (outliers.uniform(counter, 0) < config_.outlier_share) {
    for (int i = 0; i < 3; ++i) {
      const double place = outliers.uniform(counter, static_cast<std::uint64_t>(i) + 1);
      pixel[i] += kOutlierReach * (2.0 * place - 1.0);
    }
  }
  const bool has_disparity = is_right && pixel[2] > kFewestDisparity;
  return {track.id, pixel.head<2>(), has_disparity ? pixel[2] : 0.0};
}

const std::vector<SimulatedRun::Track>& SimulatedRun::tracks_of_frame(int index) const {
  while (tracks_.size() <= static_cast<std::size_t>(index)) {
    tracks_.push_back(next_tracks(static_cast<int>(tracks_.size())));
  }
  return tracks_[static_cast<std::size_t>(index)];
}

// The tracks of the frame before that are still visible, and new ones in the places left.
std::vector<SimulatedRun::Track> SimulatedRun::next_tracks(int index) const {
  const auto view_at = [&](int frame) {
    return View(trajectory_.at(seconds(frame_stamp(frame))).T_room_body, stereo_, room_);
  };
  const View view = view_at(index);
  std::vector<Track> tracks;
  std::vector<bool> was_tracked(landmarks_.size(), false);
  if (index > 0) {
    for (const Track& track : tracks_[static_cast<std::size_t>(index - 1)]) {
      was_tracked[track.landmark] = true;
      if (view.sees(landmarks_[track.landmark])) {
        tracks.push_back(track);
      }
    }
  }

  const View later = view_at(index + kFramesAhead);
  const auto limit = static_cast<std::size_t>(std::max(config_.features_per_frame, 0));
  for (const bool lasting : {true, false}) {
    for (std::size_t i = 0; i < landmarks_.size() && tracks.size() < limit; ++i) {
      if (!was_tracked[i] && view.sees(landmarks_[i]) && (!lasting || later.sees(landmarks_[i]))) {
        was_tracked[i] = true;
        tracks.push_back({LandmarkId{static_cast<std::uint32_t>(landmark_of_id_.size())}, i});
        landmark_of_id_.push_back(i);
      }
    }
  }
  return tracks;
}

Eigen::Vector3d SimulatedRun::landmark(LandmarkId id) const {
  return landmarks_[landmark_of_id_.at(static_cast<std::size_t>(id))];
}

std::vector<Eigen::Vector3d> SimulatedRun::surface_points(double spacing_m) const {
  return room_.surface_grid(spacing_m);
}

}  // namespace fleetloc
