#include "robot/inertial/preintegration.hpp"

#include <cassert>
#include <utility>

#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

// One step of the midpoint rule and how errors pass through it. With an error d of [rotation,
// position, velocity] and b of the biases: d' = F d + B b. White noise enters like a bias.
struct Step {
  double dt;
  Eigen::Matrix3d R_next_last;
  Eigen::Vector3d acceleration;  // mean of both ends, in the frame of the start
  Eigen::Matrix3d J_acceleration_rotation;
  Matrix96d B;

  Step(const Eigen::Quaterniond& R,
       const ImuSample& from,
       const ImuSample& to,
       const ImuBias& bias);

  // F * errors, without the zeros of F.
  template <int Columns>
  void advance(Eigen::Matrix<double, 9, Columns>& errors) const {
    const Eigen::Matrix<double, 3, Columns> rotation = errors.template topRows<3>();
    const Eigen::Matrix<double, 3, Columns> velocity_gain =
        dt * (J_acceleration_rotation * rotation);
    errors.template topRows<3>().noalias() = R_next_last * rotation;
    errors.template middleRows<3>(3) +=
        dt * errors.template bottomRows<3>() + (0.5 * dt) * velocity_gain;
    errors.template bottomRows<3>() += velocity_gain;
  }
};

Step::Step(const Eigen::Quaterniond& R_start_last,
           const ImuSample& from,
           const ImuSample& to,
           const ImuBias& bias)
    : dt(to_seconds(to.stamp - from.stamp)) {
  const Eigen::Vector3d phi =
      dt * (0.5 * (from.angular_velocity + to.angular_velocity) - bias.gyroscope);
  const Eigen::Vector3d force_last = from.specific_force - bias.accelerometer;
  const Eigen::Vector3d force_next = to.specific_force - bias.accelerometer;
  const Eigen::Matrix3d R_last_next = exp_so3(phi).toRotationMatrix();
  const Eigen::Matrix3d R_last = R_start_last.toRotationMatrix();
  const Eigen::Matrix3d R_next = R_last * R_last_next;
  R_next_last = R_last_next.transpose();
  acceleration = 0.5 * (R_last * force_last + R_next * force_next);

  const Eigen::Matrix3d J_next = -0.5 * R_next * hat(force_next);  // acceleration by rotation there
  J_acceleration_rotation = J_next * R_next_last - 0.5 * R_last * hat(force_last);
  const Eigen::Matrix3d J_rotation_gyroscope = -dt * right_jacobian_so3(phi);
  B.topRightCorner<3, 3>().setZero();
  B.topLeftCorner<3, 3>() = J_rotation_gyroscope;
  B.bottomLeftCorner<3, 3>() = dt * J_next * J_rotation_gyroscope;
  B.bottomRightCorner<3, 3>() = (-0.5 * dt) * (R_last + R_next);
  B.middleRows<3>(3) = (0.5 * dt) * B.bottomRows<3>();
}

// [gyroscope, gyroscope, gyroscope, accelerometer, ...]
Vector6d both(double gyroscope, double accelerometer) {
  Vector6d result;
  result << Eigen::Vector3d::Constant(gyroscope), Eigen::Vector3d::Constant(accelerometer);
  return result;
}

double square(double x) {
  return x * x;
}

// Variances of the means of [gyroscope, accelerometer] over an interval, apart from the biases. In
// a gap either end is all that is known: the mean of a random walk from there has q^2 dt / 3.
Vector6d white_variance(const ImuNoise& noise, double dt) {
  Vector6d variance =
      both(square(noise.gyroscope_noise_density), square(noise.accelerometer_noise_density)) / dt;
  const ImuGapModel& gaps = noise.gaps;
  if (gaps.bridged_from_s > 0.0 && dt > gaps.bridged_from_s) {
    variance += both(square(gaps.angular_acceleration), square(gaps.jerk)) * (dt / 3.0);
  }
  return variance;
}

}  // namespace

Preintegration::Preintegration(std::span<const ImuSample> samples,
                               ImuBias bias,
                               const ImuNoise& noise,
                               Duration standstill)
    : samples_(samples.begin(), samples.end()),
      bias_(std::move(bias)),
      noise_(noise),
      standstill_(standstill) {
  assert(samples_.size() >= 2);
  for (std::size_t i = 1; i < samples_.size(); ++i) {
    assert(samples_[i - 1].stamp < samples_[i].stamp);
    integrate(samples_[i - 1], samples_[i]);
  }
}

void Preintegration::integrate(const ImuSample& from, const ImuSample& to) {
  const Step step(deltas_.R, from, to, bias_);
  const double dt = step.dt;

  // A mean over dt of white noise of density s has variance s^2 / dt. Samples at both ends are
  // shared with the neighbours; counted as if each interval had noise of its own, they add up to
  // the right s^2 per second. The walk of the bias counts with its variance at mid-step.
  const double walked = to_seconds(standstill_ + (from.stamp - samples_.front().stamp)) + 0.5 * dt;
  const Vector6d walk =
      walked * both(square(noise_.gyroscope_random_walk), square(noise_.accelerometer_random_walk));
  const Vector6d white = white_variance(noise_, dt);
  step.advance(bias_walk_covariance_);
  step.advance(covariance_);
  covariance_.transposeInPlace();
  step.advance(covariance_);
  const Matrix96d half = bias_walk_covariance_ + step.B * (0.5 * (walk + white)).asDiagonal();
  const Matrix9d added = half * step.B.transpose();
  covariance_ += added + added.transpose();
  // Within a step the position error of white noise is dt^3/3, not the dt^3/4 of its mean; so even
  // a single step has a regular covariance.
  covariance_.diagonal().segment<3>(3).array() +=
      square(noise_.accelerometer_noise_density) * dt * dt * dt / 12.0;
  bias_walk_covariance_ += step.B * walk.asDiagonal();

  step.advance(bias_jacobian_);
  bias_jacobian_ += step.B;

  deltas_.R = (deltas_.R * Eigen::Quaterniond(step.R_next_last).conjugate()).normalized();
  deltas_.p += dt * deltas_.v + (0.5 * dt * dt) * step.acceleration;
  deltas_.v += dt * step.acceleration;
}

Duration Preintegration::duration() const {
  return samples_.back().stamp - samples_.front().stamp;
}

const ImuBias& Preintegration::bias() const {
  return bias_;
}

const ImuNoise& Preintegration::noise() const {
  return noise_;
}

const Matrix9d& Preintegration::covariance() const {
  return covariance_;
}

const Matrix96d& Preintegration::bias_walk_covariance() const {
  return bias_walk_covariance_;
}

const Matrix96d& Preintegration::bias_jacobian() const {
  return bias_jacobian_;
}

Preintegration::Deltas Preintegration::deltas(const ImuBias& bias) const {
  Vector6d change;
  change << bias.gyroscope - bias_.gyroscope, bias.accelerometer - bias_.accelerometer;
  const Vector9d correction = bias_jacobian_ * change;
  return {deltas_.R * exp_so3(correction.head<3>()),
          deltas_.p + correction.segment<3>(3),
          deltas_.v + correction.tail<3>()};
}

NavState Preintegration::predict(const NavState& start) const {
  const double time = to_seconds(duration());
  const Deltas change = deltas(start.bias);
  const Eigen::Quaterniond& R = start.T_odom_body.R;
  NavState end;
  end.T_odom_body.R = (R * change.R).normalized();
  end.T_odom_body.p =
      start.T_odom_body.p + time * start.v_odom + (0.5 * time * time) * kGravity + R * change.p;
  end.v_odom = start.v_odom + time * kGravity + R * change.v;
  end.bias = start.bias;
  return end;
}

Preintegration Preintegration::relinearized(const ImuBias& bias) const {
  return {samples_, bias, noise_, standstill_};
}

}  // namespace fleetloc
