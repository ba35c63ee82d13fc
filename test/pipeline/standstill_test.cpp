// A robot that is parked on its way: its pose is held, the link is idle, and then it goes on.
#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>

#include <gtest/gtest.h>

#include "shared/geometry/covariance.hpp"
#include "shared/geometry/so3.hpp"
#include "test/pipeline/simulated_system.hpp"

namespace fleetloc {
namespace {

constexpr double kStopsAt = 20.0;  // [s]
// After it has begun to stop: its last answer is not repeated any more.
constexpr double kSettled = 40.0;
constexpr double kDrivesOn = 20.0;

/// 20 s of flight, a stop, and 20 s more.
SimulatedRun parked_flight(double stands_s) {
  SimulatedRun::Config config = noisy_flight();
  config.imu_rate_hz = 100.0;
  config.frame_rate_hz = 10.0;
  config.stop = {.at_s = kStopsAt, .stands_s = stands_s};
  return SimulatedRun(config);
}

/// What must hold of a robot from when it stands to the end.
class Parked {
 public:
  explicit Parked(double stands_s, const std::function<void(TrackedFrame&)>& disturb = {})
      : run_(parked_flight(stands_s)),
        system_(run_, map_of(run_), perfect_link(), run_.truth(Timestamp{}).T_odom_body) {
    if (disturb) {
      const double until_s = kStopsAt + 2.0 + stands_s - 1.0;
      system_.robot().disturb = [=](TrackedFrame& frame) {
        const double t = to_seconds(frame.stamp.time_since_epoch());
        if (t > kStopsAt + kSettled && t < until_s) disturb(frame);
      };
    }
    system_.play(kStopsAt + kSettled);
    begin_ = system_.robot().frames.size();
    const LinkTraffic before = system_.robot().client().traffic();
    const auto keyframes_before = system_.robot().pipeline().odometry().statistics().keyframes;
    system_.play(kStopsAt + 2.0 + stands_s);
    const LinkTraffic after = system_.robot().client().traffic();
    end_ = system_.robot().frames.size();
    const double parked_s = stands_s + 2.0 - kSettled;
    up_bytes_per_s =
        static_cast<double>(after.uplink_wire_bytes - before.uplink_wire_bytes) / parked_s;
    down_bytes_per_s =
        static_cast<double>(after.downlink_wire_bytes - before.downlink_wire_bytes) / parked_s;
    keyframes = system_.robot().pipeline().odometry().statistics().keyframes - keyframes_before;
    system_.play(kStopsAt + 2.0 + stands_s + kDrivesOn);
  }

  /// Of the odom pose, from that at the beginning.
  [[nodiscard]] double worst_drift_m() const {
    return worst_parked([this](const FrameOutput& frame) {
      return (frame.pose.T_odom_body.p - parked_pose().T_odom_body.p).norm();
    });
  }
  [[nodiscard]] double worst_drift_rad() const {
    return worst_parked([this](const FrameOutput& frame) {
      return log_so3(parked_pose().T_odom_body.R.conjugate() * frame.pose.T_odom_body.R).norm();
    });
  }
  /// Sigma of the map position, by that at the beginning.
  [[nodiscard]] double worst_growth() const {
    const auto sigma = [](const PoseEstimate& pose) {
      return max_sigma(pose.covariance_map.bottomRightCorner<3, 3>());
    };
    const double begin = sigma(parked_pose());
    return worst_parked([&](const FrameOutput& frame) { return sigma(frame.pose) / begin; });
  }
  /// In the map, from when it stands to the end of the flight.
  [[nodiscard]] double worst_error_m() const {
    double worst = 0.0;
    for (std::size_t i = begin_; i < frames().size(); ++i)
      worst = std::max(worst, error_m(frames()[i]));
    return worst;
  }
  [[nodiscard]] std::ptrdiff_t not_localized() const {
    return std::count_if(
        frames().begin() + static_cast<long>(begin_), frames().end(), [](const FrameOutput& frame) {
          return frame.pose.quality != Quality::kLocalized;
        });
  }
  /// How long it has driven on when an answer of the drive counts [s].
  [[nodiscard]] double answered_after_s() const {
    const auto answered = std::find_if(
        frames().begin() + static_cast<long>(end_), frames().end(), [](const FrameOutput& frame) {
          return frame.pose.since_last_answer < std::chrono::seconds(1);
        });
    return to_seconds((answered == frames().end() ? frames().back() : *answered).stamp -
                      frames()[end_].stamp);
  }
  [[nodiscard]] std::uint64_t resets() const {
    return system_.robot().pipeline().odometry().statistics().resets;
  }
  [[nodiscard]] double held_s() const {
    return to_seconds(system_.robot().pipeline().odometry().statistics().standstill);
  }

  double up_bytes_per_s = 0.0;    ///< on the wire, while it is parked
  double down_bytes_per_s = 0.0;  ///< likewise
  std::uint64_t keyframes = 0;    ///< likewise

 private:
  [[nodiscard]] const std::vector<FrameOutput>& frames() const { return system_.robot().frames; }
  [[nodiscard]] const PoseEstimate& parked_pose() const { return frames()[begin_].pose; }
  [[nodiscard]] double error_m(const FrameOutput& frame) const {
    return (frame.pose.T_map_body->p - run_.truth(frame.stamp).T_odom_body.p).norm();
  }
  [[nodiscard]] double worst_parked(const std::function<double(const FrameOutput&)>& value) const {
    double worst = 0.0;
    for (std::size_t i = begin_; i < end_; ++i) worst = std::max(worst, value(frames()[i]));
    return worst;
  }

  SimulatedRun run_;
  SimulatedSystem system_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

void expect_at_rest(const Parked& parked) {
  EXPECT_LT(parked.worst_drift_m(), 0.01);
  EXPECT_LT(parked.worst_drift_rad(), 0.1 * M_PI / 180.0);
  EXPECT_LT(parked.worst_growth(), 1.05);
  EXPECT_EQ(parked.keyframes, 0U);
  EXPECT_LT(parked.up_bytes_per_s, 100.0);
  EXPECT_LT(parked.down_bytes_per_s, 100.0);
  EXPECT_EQ(parked.not_localized(), 0);
  EXPECT_EQ(parked.resets(), 0U);
  EXPECT_LT(parked.worst_error_m(), 0.1) << "also once it drives on";
  EXPECT_LT(parked.answered_after_s(), 5.0);
  std::cout << "held for " << parked.held_s() << " s, drift " << 1e3 * parked.worst_drift_m()
            << " mm, " << parked.worst_drift_rad() * 180.0 / M_PI << " degrees, sigma x "
            << parked.worst_growth() << ", " << parked.up_bytes_per_s << " B/s up, "
            << parked.down_bytes_per_s << " down, worst error " << parked.worst_error_m()
            << " m, answered " << parked.answered_after_s() << " s after it drives on\n";
}

TEST(ParkedRobot, HoldsItsPoseForAnHourAndDrivesOn) {
  expect_at_rest(Parked(3600.0));
}

TEST(ParkedRobot, HoldsItsPoseForAnHourInTheDark) {
  expect_at_rest(Parked(3600.0, [](TrackedFrame& frame) { frame.observations.clear(); }));
}

// Two of ten features are on people who walk away within three seconds, each time anew, and two
// more are hidden by them.
TEST(ParkedRobot, HoldsItsPoseWhilePeoplePass) {
  expect_at_rest(Parked(120.0, [](TrackedFrame& frame) {
    const double t = std::fmod(to_seconds(frame.stamp.time_since_epoch()), 5.0);
    const auto kind = [](const StereoObservation& seen) {
      return static_cast<std::uint32_t>(seen.landmark) % 10;
    };
    for (StereoObservation& seen : frame.observations) {
      if (kind(seen) < 2) seen.left.x() += 60.0 * t;
    }
    std::erase_if(frame.observations, [&](const StereoObservation& seen) {
      return (t > 3.0 && kind(seen) < 2) || (t > 1.0 && kind(seen) / 2 == 1);
    });
  }));
}

}  // namespace
}  // namespace fleetloc
