#include "deploy/sim/sensors/imu_model.hpp"

#include <cmath>
#include <cstddef>
#include <string>

#include "shared/core/counter_random.hpp"

namespace fleetloc {
namespace {

/// Each source of error of each triad has random numbers of its own.
enum class Source : std::uint64_t { kWhite, kWalk, kInitial, kScale, kMisalignment };
enum class Kind : std::uint64_t { kGyroscope = 0x696d7500, kAccelerometer = 0x696d7510 };

CounterRandom random_of(std::uint64_t seed, Kind kind, Source source) {
  return {seed, static_cast<std::uint64_t>(kind) + static_cast<std::uint64_t>(source)};
}

struct Errors {
  double density = 0.0;
  double walk = 0.0;
  double initial_bias = 0.0;
};

/// One of the two triads.
class Triad {
 public:
  Triad(Kind kind, const Errors& errors, const ImuModelConfig& config, std::uint64_t seed)
      : white_(random_of(seed, kind, Source::kWhite)),
        walk_(random_of(seed, kind, Source::kWalk)),
        white_sigma_(errors.density * std::sqrt(config.rate_hz)),
        walk_sigma_(errors.walk / std::sqrt(config.rate_hz)),
        bias_(errors.initial_bias * random_of(seed, kind, Source::kInitial).normal3(0)) {
    const CounterRandom misalignment = random_of(seed, kind, Source::kMisalignment);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        const auto element =
            3 * static_cast<std::uint64_t>(row) + static_cast<std::uint64_t>(column);
        gain_(row, column) =
            row == column ? 1.0 : config.misalignment * misalignment.normal(element);
      }
    }
    gain_.diagonal() += config.scale_error * random_of(seed, kind, Source::kScale).normal3(0);
  }

  /// To be called for index 0, 1, 2, ...: the bias walks on.
  Eigen::Vector3d measure(const Eigen::Vector3d& truth, std::uint64_t index) {
    if (index > 0) bias_ += walk_sigma_ * walk_.normal3(index);
    return gain_ * truth + bias_ + white_sigma_ * white_.normal3(index);
  }
  [[nodiscard]] const Eigen::Vector3d& bias() const { return bias_; }

 private:
  CounterRandom white_;
  CounterRandom walk_;
  double white_sigma_;
  double walk_sigma_;
  Eigen::Vector3d bias_;
  Eigen::Matrix3d gain_;
};

/// Output of an ideal unit.
struct Truth {
  Eigen::Vector3d angular_velocity;
  Eigen::Vector3d specific_force;
};

/// From the states an interval before, at, and after the stamp. With y = x - (second difference) /
/// 12 the mean of two values is that of x between them; what the axes turn meanwhile adds
/// interval^2 / 12 w x w' (coning; Magnus expansion, second term).
Truth truth_at(const MotionState& before,
               const MotionState& here,
               const MotionState& after,
               double interval_s) {
  const auto evened = [](const Eigen::Vector3d& x0,
                         const Eigen::Vector3d& x1,
                         const Eigen::Vector3d& x2) -> Eigen::Vector3d {
    return x1 - (x0 - 2.0 * x1 + x2) / 12.0;
  };
  const Eigen::Vector3d coning =
      interval_s * interval_s / 12.0 * here.angular_velocity.cross(here.angular_acceleration);
  const Eigen::Vector3d a_map = evened(before.a_map, here.a_map, after.a_map);
  return {
      .angular_velocity =
          coning + evened(before.angular_velocity, here.angular_velocity, after.angular_velocity),
      .specific_force = here.T_map_body.R.conjugate() * (a_map - kGravity)};
}

double not_negative(ConfigReader& reader, const std::string& key) {
  const auto value = reader.get<double>(key);
  if (!(value >= 0.0 && std::isfinite(value))) throw ConfigError(key + ": must not be negative");
  return value;
}

}  // namespace

ImuModelConfig read_imu_model_config(ConfigReader section) {
  return {.rate_hz = section.positive("rate_hz"),
          .noise = {.gyroscope_noise_density = section.positive("gyroscope_noise_density"),
                    .gyroscope_random_walk = section.positive("gyroscope_random_walk"),
                    .accelerometer_noise_density = section.positive("accelerometer_noise_density"),
                    .accelerometer_random_walk = section.positive("accelerometer_random_walk")},
          .initial_gyroscope_bias = not_negative(section, "initial_gyroscope_bias"),
          .initial_accelerometer_bias = not_negative(section, "initial_accelerometer_bias"),
          .scale_error = not_negative(section, "scale_error"),
          .misalignment = not_negative(section, "misalignment_rad")};
}

ImuRecord measured_imu(const SplineMotion& motion,
                       const ImuModelConfig& config,
                       Timestamp start,
                       std::uint64_t seed) {
  const ImuNoise& noise = config.noise;
  Triad gyroscope(Kind::kGyroscope,
                  {.density = noise.gyroscope_noise_density,
                   .walk = noise.gyroscope_random_walk,
                   .initial_bias = config.initial_gyroscope_bias},
                  config,
                  seed);
  Triad accelerometer(Kind::kAccelerometer,
                      {.density = noise.accelerometer_noise_density,
                       .walk = noise.accelerometer_random_walk,
                       .initial_bias = config.initial_accelerometer_bias},
                      config,
                      seed);
  constexpr double kSlack = 1e-9;
  const auto last = static_cast<std::uint64_t>(motion.duration() * config.rate_hz + kSlack);
  ImuRecord record;
  record.samples.reserve(last + 1);
  record.biases.reserve(last + 1);
  const double interval_s = 1.0 / config.rate_hz;
  for (std::uint64_t i = 0; i <= last; ++i) {
    const Duration after_start = from_seconds(static_cast<double>(i) / config.rate_hz);
    const double time_s = to_seconds(after_start);
    const Truth truth = truth_at(motion.at(time_s - interval_s),
                                 motion.at(time_s),
                                 motion.at(time_s + interval_s),
                                 interval_s);
    record.samples.push_back({.stamp = start + after_start,
                              .angular_velocity = gyroscope.measure(truth.angular_velocity, i),
                              .specific_force = accelerometer.measure(truth.specific_force, i)});
    record.biases.push_back({.gyroscope = gyroscope.bias(), .accelerometer = accelerometer.bias()});
  }
  return record;
}

}  // namespace fleetloc
