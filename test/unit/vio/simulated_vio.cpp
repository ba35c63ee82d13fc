#include "test/unit/vio/simulated_vio.hpp"

#include <Eigen/Cholesky>

#include "deploy/config/default_config.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// Yaw and position that bring the truth to an estimate.
Pose gauge_between(const Pose& T_odom_body, const Pose& T_room_body) {
  const double yaw = log_so3(T_odom_body.R * T_room_body.R.conjugate()).z();
  Pose T_odom_room;
  T_odom_room.R = exp_so3(yaw * Eigen::Vector3d::UnitZ());
  T_odom_room.p = T_odom_body.p - T_odom_room.R * T_room_body.p;
  return T_odom_room;
}

// The rotation between both is a yaw and a tilt; the yaw of the product, for any size of it.
Pose exact_gauge_between(const Pose& T_odom_body, const Pose& T_room_body) {
  const Eigen::Quaterniond R = T_odom_body.R * T_room_body.R.conjugate();
  Pose T_odom_room;
  T_odom_room.R = Eigen::Quaterniond(R.w(), 0.0, 0.0, R.z()).normalized();
  T_odom_room.p = T_odom_body.p - T_odom_room.R * T_room_body.p;
  const Pose rest = gauge_between(T_odom_body, T_odom_room * T_room_body);
  return rest * T_odom_room;
}

CheckedState checked(const NavState& estimate,
                     const Matrix15d& covariance,
                     const NavState& truth,
                     const Pose& T_odom_room) {
  CheckedState state;
  state.covariance = covariance;
  state.error << local_coordinates(estimate.T_odom_body, T_odom_room * truth.T_odom_body),
      T_odom_room.R * truth.v_odom - estimate.v_odom,
      truth.bias.gyroscope - estimate.bias.gyroscope,
      truth.bias.accelerometer - estimate.bias.accelerometer;
  return state;
}

class Player {
 public:
  Player(const SimulatedRun& run, const VioConfig& config)
      : run_(run),
        config_(config),
        initializer_(run.stereo(), run.noise(), config.initializer),
        frame_estimator_(run.stereo(), run.noise(), config.frame_estimator) {}

  void add_frame(int index) {
    const Timestamp stamp = run_.frame_stamp(index);
    for (const ImuSample& sample : run_.imu(run_.frame_stamp(std::max(0, index - 1)), stamp)) {
      imu_.add(sample);
    }
    const TrackedFrame frame = run_.frame(index);
    if (!window_.has_value()) {
      initialize(index, frame);
    } else {
      follow(frame);
    }
  }

  PlayedRun result;

 private:
  void initialize(int index, const TrackedFrame& frame) {
    const std::vector<ImuSample> samples =
        index == 0 ? std::vector<ImuSample>{}
                   : imu_.between(run_.frame_stamp(index - 1), frame.stamp);
    auto initialization = initializer_.add(frame, samples);
    if (!initialization) return;
    result.initialization = std::move(*initialization);
    result.initialized_s = to_seconds(frame.stamp - run_.frame_stamp(0));
    result.T_first_newest_truth =
        inverse(run_.truth(run_.frame_stamp(0)).T_odom_body) * run_.truth(frame.stamp).T_odom_body;
    window_.emplace(run_.stereo(), run_.noise(), config_.window, *result.initialization);
    next_id_ = static_cast<std::uint32_t>(result.initialization->keyframes.size());
    const WindowKeyframe& oldest = window_->estimate().keyframes.front();
    T_odom_room_ =
        exact_gauge_between(oldest.state.T_odom_body, run_.truth(oldest.stamp).T_odom_body);
    take(window_->estimate());
  }

  void follow(const TrackedFrame& frame) {
    const auto estimated = frame_estimator_.estimate(frame, imu_);
    if (!estimated.has_value()) {
      return;
    }
    result.frames.push_back(checked(estimated->estimate.state,
                                    estimated->estimate.covariance,
                                    run_.truth(frame.stamp),
                                    T_odom_room_));
    if (estimated->wants_keyframe) {
      frame_estimator_.set_reference_keyframe(frame, estimated->estimate.state);
      const Timestamp last = window_->estimate().keyframes.back().stamp;
      take(window_->add({KeyframeId{next_id_++}, frame, imu_.between(last, frame.stamp)}));
    }
  }

  void take(const WindowEstimate& estimate) {
    const WindowKeyframe& newest = estimate.keyframes.back();
    result.keyframes.push_back(
        checked(newest.state, estimate.covariance, run_.truth(newest.stamp), T_odom_room_));
    result.windows.push_back(estimate);
    frame_estimator_.update(std::make_shared<WindowEstimate>(estimate));
  }

  const SimulatedRun& run_;
  VioConfig config_;
  Initializer initializer_;
  FrameEstimator frame_estimator_;
  std::optional<SlidingWindow> window_;
  ImuBuffer imu_;
  std::uint32_t next_id_ = 0;
  Pose T_odom_room_;
};

}  // namespace

VioConfig simulated_vio_config(double pixel_sigma) {
  VioConfig config =
      read_vio_config(ConfigReader::from_string(default_config("robot")).section("vio"));
  const VioNoise noise{pixel_sigma, 1.0, 1.0};
  config.window.noise = noise;
  config.initializer.window.noise = noise;
  config.initializer.odometry.pixel_sigma = pixel_sigma;
  config.frame_estimator.noise = noise;
  return config;
}

double CheckedState::nees() const {
  return nees(0, 15);
}

double CheckedState::nees(int begin, int size) const {
  const Eigen::VectorXd part = error.segment(begin, size);
  const Eigen::MatrixXd P = covariance.block(begin, begin, size, size);
  return part.dot(P.ldlt().solve(part));
}

PlayedRun play(const SimulatedRun& run, const VioConfig& config, double seconds) {
  Player player(run, config);
  for (int i = 0; to_seconds(run.frame_stamp(i) - run.frame_stamp(0)) <= seconds; ++i) {
    player.add_frame(i);
  }
  return player.result;
}

KeyframeInput keyframe_input(const SimulatedRun& run, int frame, int previous, std::uint32_t id) {
  KeyframeInput input{KeyframeId{id}, run.frame(frame), {}};
  if (previous >= 0) {
    ImuBuffer buffer;
    for (const ImuSample& sample : run.imu(run.frame_stamp(previous), run.frame_stamp(frame))) {
      buffer.add(sample);
    }
    input.imu = buffer.between(run.frame_stamp(previous), run.frame_stamp(frame));
  }
  return input;
}

Initialization true_initialization(const SimulatedRun& run, int first, int count, int interval) {
  Initialization initialization;
  for (int i = 0; i < count; ++i) {
    const int frame = first + i * interval;
    initialization.keyframes.push_back(
        keyframe_input(run, frame, i == 0 ? -1 : frame - interval, static_cast<std::uint32_t>(i)));
    initialization.states.push_back(run.truth(run.frame_stamp(frame)));
  }
  return initialization;
}

}  // namespace fleetloc
