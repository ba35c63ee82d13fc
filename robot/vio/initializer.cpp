#include "robot/vio/initializer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace fleetloc {
namespace {

constexpr std::size_t kMinKeyframes = 4;

// The IMU of one keyframe interval from those of its frames, which share their end samples.
void append_samples(const std::vector<ImuSample>& more, std::vector<ImuSample>& samples) {
  const auto begin = samples.empty() ? more.begin() : more.begin() + 1;
  samples.insert(samples.end(), begin, more.end());
}

std::vector<NavState> aligned_states(const InertialAlignment& alignment,
                                     const std::vector<Pose>& T_first_body) {
  const Pose T_odom_first{
      Eigen::Quaterniond::FromTwoVectors(-alignment.g_first, Eigen::Vector3d::UnitZ()),
      Eigen::Vector3d::Zero()};
  std::vector<NavState> states;
  for (std::size_t i = 0; i < T_first_body.size(); ++i) {
    states.push_back(
        {T_odom_first * T_first_body[i], T_odom_first.R * alignment.v_first[i], alignment.bias});
  }
  return states;
}

}  // namespace

std::string_view name(NotInitialized reason) {
  switch (reason) {
    case NotInitialized::kCollecting:
      return "collecting";
    case NotInitialized::kVisionLost:
      return "vision_lost";
    case NotInitialized::kImplausibleGravity:
      return "implausible_gravity";
    case NotInitialized::kImplausibleBias:
      return "implausible_bias";
    case NotInitialized::kResiduals:
      return "residuals";
  }
  return "unknown";
}

Initializer::Initializer(const RectifiedStereo& stereo, const ImuNoise& noise, const Config& config)
    : stereo_(stereo), noise_(noise), config_(config), odometry_(stereo, config.odometry) {}

expected<Initialization, NotInitialized> Initializer::add(
    const TrackedFrame& frame, std::span<const ImuSample> since_previous_frame) {
  if (!frames_.empty() && !continues(since_previous_frame)) restart();
  std::optional<Pose> T_first_body = odometry_.add(frame);
  const bool is_lost = !T_first_body;
  if (is_lost) {
    restart();
    T_first_body = odometry_.add(frame);
  }
  frames_.push_back(
      {frame, {since_previous_frame.begin(), since_previous_frame.end()}, *T_first_body});
  if (is_lost) return unexpected(NotInitialized::kVisionLost);
  if (to_seconds(frame.stamp - frames_.front().frame.stamp) < config_.duration_s) {
    return unexpected(NotInitialized::kCollecting);
  }
  auto result = align();
  if (result) {
    reset();
  } else {  // next attempt after another interval
    std::erase_if(frames_, [&](const Frame& old) {
      return to_seconds(frame.stamp - old.frame.stamp) >
             config_.duration_s - config_.keyframe_interval_s;
    });
  }
  return result;
}

bool Initializer::continues(std::span<const ImuSample> since_previous_frame) const {
  return since_previous_frame.size() > 1 &&
         since_previous_frame.front().stamp == frames_.back().frame.stamp;
}

void Initializer::restart() {
  odometry_ = StereoOdometry(stereo_, config_.odometry);
  frames_.clear();
  starts_at_first_frame_ = false;
}

void Initializer::reset() {
  restart();
  starts_at_first_frame_ = true;
}

// Backwards from the newest frame, which is always chosen.
std::vector<std::size_t> Initializer::choose_keyframes() const {
  std::vector<std::size_t> chosen{frames_.size() - 1};
  const auto max_frames = static_cast<std::size_t>(config_.window.keyframes);
  for (std::size_t i = frames_.size() - 1; i-- > 0 && chosen.size() < max_frames;) {
    const Duration since = frames_[chosen.back()].frame.stamp - frames_[i].frame.stamp;
    if (to_seconds(since) >= config_.keyframe_interval_s) {
      chosen.push_back(i);
    }
  }
  std::reverse(chosen.begin(), chosen.end());
  return chosen;
}

expected<Initialization, NotInitialized> Initializer::align() const {
  const std::vector<std::size_t> chosen = choose_keyframes();
  if (chosen.size() < kMinKeyframes) return unexpected(NotInitialized::kCollecting);
  Initialization result;
  std::vector<Pose> T_first_body;
  std::vector<Preintegration> between;
  const ImuNoise noise = inflated(noise_, config_.window.noise);
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    KeyframeInput keyframe{KeyframeId{static_cast<std::uint32_t>(k)}, frames_[chosen[k]].frame, {}};
    for (std::size_t i = k == 0 ? chosen[k] : chosen[k - 1]; i < chosen[k]; ++i) {
      append_samples(frames_[i + 1].imu, keyframe.imu);
    }
    if (k > 0) {
      between.emplace_back(keyframe.imu, ImuBias{}, noise);
    }
    T_first_body.push_back(frames_[chosen[k]].T_first_body);
    result.keyframes.push_back(std::move(keyframe));
  }
  const InertialAlignment alignment =
      align_inertially(T_first_body,
                       std::move(between),
                       {config_.position_sigma_m, config_.window.accelerometer_bias_sigma});
  if (const auto plausible = check(alignment); !plausible) return unexpected(plausible.error());
  result.states = aligned_states(alignment, T_first_body);
  return refined(std::move(result)).map([&](Initialization initialization) {
    if (starts_at_first_frame_) {
      initialization.T_first_newest = T_first_body.front() *
                                      inverse(initialization.states.front().T_odom_body) *
                                      initialization.states.back().T_odom_body;
    }
    return initialization;
  });
}

expected<void, NotInitialized> Initializer::check(const InertialAlignment& alignment) const {
  if (!(std::abs(alignment.estimated_gravity - kGravity.norm()) < config_.max_gravity_error)) {
    return unexpected(NotInitialized::kImplausibleGravity);
  }
  if (!plausible(alignment.bias)) return unexpected(NotInitialized::kImplausibleBias);
  return {};
}

bool Initializer::plausible(const ImuBias& bias) const {
  return bias.gyroscope.norm() < config_.max_gyroscope_bias &&
         bias.accelerometer.norm() < config_.max_accelerometer_bias;
}

// Optimizes the initial window and checks its residuals.
expected<Initialization, NotInitialized> Initializer::refined(Initialization initialization) const {
  const SlidingWindow window(stereo_, noise_, config_.window, initialization);
  const WindowEstimate& estimate = window.estimate();
  const double residuals = 3.0 * std::max(estimate.diagnostics.observations, 1);
  if (!estimate.diagnostics.converged ||
      !(estimate.diagnostics.final_cost < config_.max_cost_per_residual * residuals)) {
    return unexpected(NotInitialized::kResiduals);
  }
  for (std::size_t i = 0; i < initialization.states.size(); ++i) {
    initialization.states[i] = estimate.keyframes[i].state;
  }
  if (!plausible(initialization.states.back().bias)) {
    return unexpected(NotInitialized::kImplausibleBias);
  }
  return initialization;
}

Initializer::Config read_initializer_config(ConfigReader section,
                                            const SlidingWindow::Config& window) {
  Initializer::Config config;
  config.window = window;
  config.odometry =
      read_stereo_odometry_config(section.section("odometry"), window.noise.pixel_sigma);
  config.duration_s = section.positive("duration_s");
  config.keyframe_interval_s = section.positive("keyframe_interval_s");
  config.position_sigma_m = section.positive("position_sigma_m");
  config.max_gravity_error = section.positive("max_gravity_error");
  config.max_gyroscope_bias = section.positive("max_gyroscope_bias");
  config.max_accelerometer_bias = section.positive("max_accelerometer_bias");
  config.max_cost_per_residual = section.positive("max_cost_per_residual");
  return config;
}

}  // namespace fleetloc
