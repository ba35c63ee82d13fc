#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "robot/sensors/sensor_source.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {

enum class FaultKind {
  kBlackImages,
  kSaturatedImages,
  kFrozenImages,  ///< the last pair before, repeated with new stamps
  kMissingLeft,
  kMissingRight,
  kDroppedFrames,
  kDoubledFrames,
  kDisorderedFrames,  ///< a frame arrives after its successor
  kResizedImages,     ///< as of another mode of the camera: their upper left quarter
  kZeroImageStamps,   ///< nobody has set them
  kImuGap,
  kDoubledImu,
  kDisorderedImu,  ///< a sample arrives after its successor
  kNonFiniteImu,
  kZeroImuStamps,
  kClockStep,  ///< of the whole robot: it stays set
};

/// Its name in files, e.g. "black_images".
std::string_view name(FaultKind kind);

/// A fault from `start_s` on, in seconds since the first image of the recording.
struct Fault {
  FaultKind kind{};
  double start_s = 0.0;
  double duration_s = 0.0;
  double share = 1.0;   ///< of the measurements, drawn at random
  double step_s = 0.0;  ///< of a clock step: forward, or back; it has no duration
};

struct FaultPlan {
  std::uint64_t seed = 1;
  std::vector<Fault> faults;
};

/// `seed`, and a list `faults` of {kind, start_s, duration_s}, to which dropped, doubled,
/// disordered and non-finite measurements add `share`; {kind: clock_step, start_s, step_s}.
FaultPlan read_fault_plan(ConfigReader config);

/// A recording with the faults of a plan. Causal, and the same for one seed. A ClockStep comes with
/// each clock_step, as from live sensors; who publishes the rest leaves it out.
class FaultInjector final : public SensorSource {
 public:
  /// @param start  from which the plan counts time
  FaultInjector(std::unique_ptr<SensorSource> recording, Timestamp start, FaultPlan plan);

  /// Stamps may repeat, go back and be zero.
  std::optional<SensorMeasurement> next(const std::stop_token& stop) override;
  using SensorSource::next;

  [[nodiscard]] std::optional<std::size_t> frame_count() const override {
    return recording_->frame_count();
  }

  /// The recording's own, and by "injected_" and the name of the kind how many measurements were
  /// touched.
  std::map<std::string, std::uint64_t> close() override;

 private:
  bool occurs(std::size_t fault, Timestamp stamp);
  void take(CameraFrame frame);
  void take(const GivenPose& given) { ready_.emplace_back(given); }
  void take(const ImuSample& sample);
  void take(const ClockStep& step);
  void step_clock(Timestamp stamp);
  void deliver(SensorMeasurement measurement,
               std::optional<SensorMeasurement>& held_back,
               bool twice,
               bool late);

  std::unique_ptr<SensorSource> recording_;
  Timestamp start_;
  FaultPlan plan_;
  std::vector<std::mt19937_64> random_;    // of each fault, so that none disturbs another
  std::vector<std::uint64_t> injected_;    // by each fault
  std::optional<CameraFrame> last_frame_;  // before its successor came, as it was given out
  std::optional<SensorMeasurement> late_frame_;
  std::optional<SensorMeasurement> late_sample_;
  Duration clock_ahead_{};             // of the recording's
  std::optional<Timestamp> last_imu_;  // by the recording's clock
  std::deque<SensorMeasurement> ready_;
};

}  // namespace fleetloc
