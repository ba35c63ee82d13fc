// What the fusion costs with a full buffer: 30 s of IMU at 200 Hz, frames at 20 Hz, and answers to
// two frames per second.
#include <memory>

#include <benchmark/benchmark.h>

#include "test/unit/fusion/fed_fusion.hpp"

namespace fleetloc {
namespace {

constexpr double kImuInterval = 0.005;
constexpr int kTicksPerFrame = 10;
constexpr int kTicksPerAnswer = 100;
constexpr int kFullBuffer = 8000;

class BusyFusion {
 public:
  BusyFusion() {
    while (tick_ < kFullBuffer) {
      add_imu();
      add_what_is_due();
    }
  }
  PoseEstimate add_imu() { return fusion_->add_imu(drive_.imu(kImuInterval * ++tick_)); }

  void add_what_is_due() {
    if (tick_ % kTicksPerFrame == 0) {
      add_frame();
    }
    if (tick_ % kTicksPerAnswer == 0) {
      add_answer(kImuInterval * tick_ - 1.0);
    }
  }
  // 50 ms late, which is one frame.
  void add_frame() {
    const double stamp = kImuInterval * (tick_ - kTicksPerFrame);
    fusion_->add_odometry(odometry(stamp, drive_.state(stamp)));
  }
  // Every call is a revision that replaces the one before, so that all cost the same.
  void add_answer(double stamp) {
    LocalizationResult current = answer(stamp, true_T_map_odom() * drive_.pose(stamp));
    current.revision = Revision{++revision_};
    benchmark::DoNotOptimize(fusion_->add_answer(current));
  }
  [[nodiscard]] double now() const { return kImuInterval * tick_; }
  [[nodiscard]] bool frame_is_due() const { return tick_ % kTicksPerFrame == 0; }

 private:
  CircularDrive drive_;
  std::unique_ptr<PoseFusion> fusion_ = make_pose_fusion(euroc_imu_noise(), fusion_config());
  int tick_ = 0;
  std::uint32_t revision_ = 0;
};

void imu_sample(benchmark::State& state) {
  BusyFusion fusion;
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(fusion.add_imu());
    if (fusion.frame_is_due()) {
      state.PauseTiming();
      fusion.add_what_is_due();
      state.ResumeTiming();
    }
  }
}
BENCHMARK(imu_sample)->Unit(benchmark::kMicrosecond);

// With all that is replayed: 10 samples on each frame.
void imu_sample_and_its_share_of_frames(benchmark::State& state) {
  BusyFusion fusion;
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(fusion.add_imu());
    if (fusion.frame_is_due()) {
      fusion.add_frame();
    }
  }
}
BENCHMARK(imu_sample_and_its_share_of_frames)->Unit(benchmark::kMicrosecond);

void answer_five_seconds_late(benchmark::State& state) {
  BusyFusion fusion;
  while (state.KeepRunning()) {
    fusion.add_answer(fusion.now() - 5.0);
  }
}
BENCHMARK(answer_five_seconds_late)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace fleetloc
