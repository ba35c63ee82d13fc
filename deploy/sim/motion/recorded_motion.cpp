#include "deploy/sim/motion/recorded_motion.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shared/core/percentile.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr double kHuberMedians = 2.5;  // residuals above that many medians count less
constexpr double kOutlierWeight = 0.33;
constexpr int kRobustRounds = 4;     // until the weights have settled
constexpr double kStiffening = 4.0;  // of the penalty in one round, where a limit is exceeded

/// What remains to be decided of position or rotation: how stiff the spline is in each interval.
struct Channel {
  SplineSamples samples;
  double penalty = 0.0;  ///< at the configured cutoff
  double cutoff_hz = 0.0;
  std::vector<double> stiffness;  ///< factor of the penalty in each interval
  Eigen::MatrixXd coefficients;
};

double median_of(const std::vector<double>& values) {
  return percentile(values, 0.5).value_or(0.0);
}

std::vector<double> residual_norms(const SplineGrid& grid, const Channel& channel) {
  const Eigen::MatrixXd values = spline_values(grid, channel.coefficients, channel.samples.times_s);
  const Eigen::VectorXd norms = (values - channel.samples.values).rowwise().norm();
  return {norms.begin(), norms.end()};
}

void refit(const SplineGrid& grid, Channel& channel) {
  std::vector<double> penalties = channel.stiffness;
  for (double& penalty : penalties) penalty *= channel.penalty;
  channel.coefficients = fit_quintic_spline(grid, channel.samples, penalties);
}

/// Huber's weights at the present residuals.
void reweight(const SplineGrid& grid, Channel& channel) {
  constexpr double kMin = 1e-9;
  const std::vector<double> norms = residual_norms(grid, channel);
  const double bound = std::max(kMin, kHuberMedians * median_of(norms));
  for (std::size_t i = 0; i < norms.size(); ++i) {
    channel.samples.weights[i] = std::min(1.0, bound / std::max(kMin, norms[i]));
  }
}

Channel fitted_channel(const SplineGrid& grid,
                       SplineSamples samples,
                       double cutoff_hz,
                       double sample_interval_s) {
  Channel channel{.samples = std::move(samples),
                  .penalty = penalty_for_cutoff(cutoff_hz, sample_interval_s),
                  .cutoff_hz = cutoff_hz,
                  .stiffness = std::vector<double>(static_cast<std::size_t>(grid.intervals), 1.0),
                  .coefficients = {}};
  refit(grid, channel);
  for (int i = 0; i < kRobustRounds; ++i) {
    reweight(grid, channel);
    refit(grid, channel);
  }
  return channel;
}

SplineMotion motion_of(const SplineGrid& grid, const Channel& position, const Channel& rotation) {
  SplineMotion::Coefficients all(grid.coefficients(), 7);
  all << position.coefficients, rotation.coefficients;
  return {grid, std::move(all)};
}

/// How far each interval is beyond the limits, as a ratio, for position and rotation.
struct Excess {
  std::vector<double> position;
  std::vector<double> rotation;
};

Excess excess_of(const SplineMotion& motion, const MotionMagnitudes& limits) {
  constexpr int kPerInterval = 4;
  const SplineGrid& grid = motion.grid();
  Excess excess;
  for (int k = 0; k < grid.intervals; ++k) {
    MotionMagnitudes most;
    for (int i = 0; i <= kPerInterval; ++i) {
      const double time_s = grid.interval_s * (k + static_cast<double>(i) / kPerInterval);
      most = greatest(most, magnitudes(motion.at(time_s)));
    }
    excess.position.push_back(
        std::max(most.speed / limits.speed, most.acceleration / limits.acceleration));
    excess.rotation.push_back(std::max(most.turn_rate / limits.turn_rate,
                                       most.angular_acceleration / limits.angular_acceleration));
  }
  return excess;
}

/// Stiffens the spline around the intervals that are beyond a limit, over a period of their cutoff
/// to either side. False if there are none.
bool stiffen(const SplineGrid& grid, const std::vector<double>& excess, Channel& channel) {
  const auto intervals = static_cast<int>(excess.size());
  std::vector<double> share(excess.size(), 0.0);
  bool any = false;
  for (int k = 0; k < intervals; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (excess[at] <= 1.0) continue;
    any = true;
    const double cutoff_hz = channel.cutoff_hz / std::pow(channel.stiffness[at], 1.0 / 6.0);
    const int reach = std::max(2, static_cast<int>(std::lround(1.0 / cutoff_hz / grid.interval_s)));
    for (int j = std::max(0, k - reach); j < std::min(intervals, k + reach); ++j) {
      const double taper = 1.0 - static_cast<double>(std::abs(j - k)) / reach;
      share[static_cast<std::size_t>(j)] = std::max(share[static_cast<std::size_t>(j)], taper);
    }
  }
  for (std::size_t k = 0; k < share.size(); ++k) {
    channel.stiffness[k] *= std::pow(kStiffening, share[k]);
  }
  return any;
}

FitResidual residual_of(const std::vector<double>& distances) {
  return {.median = median_of(distances),
          .p95 = percentile(distances, 0.95).value_or(0.0),
          .max = percentile(distances, 1.0).value_or(0.0)};
}

/// Sorted by stamp, as times since the first one.
struct Record {
  std::vector<StampedPose> poses;
  std::vector<double> times_s;
  std::size_t repeated_stamps = 0;
  double interval_s = 0.0;  ///< median between different stamps
};

Record sorted_record(std::span<const StampedPose> poses, double max_gap_s) {
  constexpr std::size_t kFewest = 8;
  Record record{.poses = {poses.begin(), poses.end()}, .times_s = {}};
  std::ranges::stable_sort(record.poses, {}, &StampedPose::stamp);
  std::vector<double> intervals_s;
  for (const StampedPose& pose : record.poses) {
    record.times_s.push_back(to_seconds(pose.stamp - record.poses.front().stamp));
    if (record.times_s.size() == 1) continue;
    const double interval_s = record.times_s.back() - record.times_s[record.times_s.size() - 2];
    if (interval_s > max_gap_s) {
      throw std::invalid_argument("the record has a gap of " + std::to_string(interval_s) + " s, " +
                                  std::to_string(record.times_s.back() - interval_s) +
                                  " s after its start");
    }
    if (interval_s > 0.0) {
      intervals_s.push_back(interval_s);
    } else {
      ++record.repeated_stamps;
    }
  }
  if (intervals_s.size() + 1 < kFewest) {
    throw std::invalid_argument("the record holds fewer than " + std::to_string(kFewest) +
                                " poses of different stamps");
  }
  record.interval_s = median_of(intervals_s);
  return record;
}

SplineSamples samples_of(const Record& record, Eigen::Index columns) {
  return {.times_s = record.times_s,
          .weights = std::vector<double>(record.poses.size(), 1.0),
          .values = Eigen::MatrixXd(static_cast<Eigen::Index>(record.poses.size()), columns)};
}

SplineSamples positions(const Record& record) {
  SplineSamples samples = samples_of(record, 3);
  Eigen::Index row = 0;
  for (const StampedPose& pose : record.poses) {
    samples.values.row(row++) = pose.T_ref_body.p.transpose();
  }
  return samples;
}

SplineSamples rotations(const Record& record) {
  SplineSamples samples = samples_of(record, 4);
  Eigen::Vector4d last = Eigen::Vector4d::Zero();
  Eigen::Index row = 0;
  for (const StampedPose& pose : record.poses) {
    last = continued_quaternion(pose.T_ref_body.R, last);
    samples.values.row(row++) = last.transpose();
  }
  return samples;
}

std::size_t count_outliers(const Channel& position, const Channel& rotation) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < position.samples.weights.size(); ++i) {
    const double weight = std::min(position.samples.weights[i], rotation.samples.weights[i]);
    if (weight < kOutlierWeight) ++count;
  }
  return count;
}

RecordFit described(SplineMotion motion, const Record& record) {
  std::vector<double> distances_m;
  std::vector<double> angles_deg;
  for (std::size_t i = 0; i < record.poses.size(); ++i) {
    const Pose truth = motion.at(record.times_s[i]).T_map_body;
    const Pose& recorded = record.poses[i].T_ref_body;
    distances_m.push_back((truth.p - recorded.p).norm());
    angles_deg.push_back(kDegPerRad * log_so3(truth.R.conjugate() * recorded.R).norm());
  }
  const MotionMagnitudes most = extremes(motion);
  return {.motion = std::move(motion),
          .start = record.poses.front().stamp,
          .position_m = residual_of(distances_m),
          .rotation_deg = residual_of(angles_deg),
          .greatest = most,
          .repeated_stamps = record.repeated_stamps};
}

}  // namespace

RecordFit fit_record(std::span<const StampedPose> poses, const RecordFitConfig& config) {
  const Record record = sorted_record(poses, config.max_gap_s);
  const SplineGrid grid = grid_over(record.times_s.back(), config.knot_interval_s);
  Channel position =
      fitted_channel(grid, positions(record), config.position_cutoff_hz, record.interval_s);
  Channel rotation =
      fitted_channel(grid, rotations(record), config.rotation_cutoff_hz, record.interval_s);
  bool within_limits = false;
  for (int round = 0; round < config.max_rounds && !within_limits; ++round) {
    const Excess excess = excess_of(motion_of(grid, position, rotation), config.limits);
    const bool stiffer_position = stiffen(grid, excess.position, position);
    const bool stiffer_rotation = stiffen(grid, excess.rotation, rotation);
    if (stiffer_position) refit(grid, position);
    if (stiffer_rotation) refit(grid, rotation);
    within_limits = !stiffer_position && !stiffer_rotation;
  }
  RecordFit fit = described(motion_of(grid, position, rotation), record);
  fit.outliers = count_outliers(position, rotation);
  fit.within_limits = within_limits;
  return fit;
}

}  // namespace fleetloc
