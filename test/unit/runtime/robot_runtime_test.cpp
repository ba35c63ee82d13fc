#include "robot/runtime/robot_runtime.hpp"

#include <algorithm>
#include <functional>
#include <stdexcept>

#include <gmock/gmock.h>

#include "deploy/replay/simulated_back_end.hpp"
#include "test/looped_flight.hpp"
#include "test/truthful_localizer.hpp"

namespace fleetloc {
namespace {

using ::testing::Contains;
using ::testing::Pair;

/// Three seconds of a flight; may fail after some measurements.
class Sensors final : public SensorSource {
 public:
  std::optional<SensorMeasurement> next(const std::stop_token& stop) override {
    if (++given_ == failing_at) throw std::runtime_error("the camera is gone");
    return flight.next(stop);
  }
  [[nodiscard]] std::optional<std::size_t> frame_count() const override { return std::nullopt; }
  std::map<std::string, std::uint64_t> close() override {
    ++closed;
    return {{"dropped_frames", 3}};
  }

  LoopedFlight flight{60};
  int failing_at = 0;
  int closed = 0;

 private:
  int given_ = 0;
};

class Recorder final : public RobotSink {
 public:
  void add(const RobotOutput& output) override {
    EXPECT_EQ(finished, 0);
    if (output.pose) poses.push_back(output.pose->stamp);
    frames += output.frames.size();
    answers += output.answers.size();
    if (on_output) on_output();
  }
  [[nodiscard]] std::map<std::string, std::uint64_t> faults() const override {
    return {{"unpublished_poses", 2}};
  }
  void finish(const RunEnd& end) override {
    ++finished;
    interrupted = end.interrupted;
    faults_at_end = end.faults;
  }

  std::vector<Timestamp> poses;
  std::size_t frames = 0;
  std::size_t answers = 0;
  int finished = 0;
  bool interrupted = false;
  std::map<std::string, std::uint64_t> faults_at_end;
  std::function<void()> on_output;
};

class RobotRuntimeTest : public testing::Test {
 protected:
  void run(const std::stop_token& stop = {}) {
    RobotRuntime("robot", sensors_, robot_, {first_, second_}).run(stop);
  }

  Sensors sensors_;
  TruthfulLocalizer localizer_{[this](Timestamp stamp) { return sensors_.flight.truth(stamp); }};
  SimulatedBackEnd back_end_{KeyframeWorker(sensors_.flight.run().stereo(),
                                            sensors_.flight.run().noise(),
                                            read_keyframe_worker_config(defaults()),
                                            {}),
                             std::chrono::milliseconds(50)};
  RobotPipeline robot_{{.id = "robot",
                        .calibration = ideal_cameras(sensors_.flight.run().stereo()),
                        .imu_noise = sensors_.flight.run().noise(),
                        .T_map_body = sensors_.flight.truth(Timestamp{})},
                       read_robot_pipeline_config(defaults()),
                       back_end_,
                       &localizer_};
  Recorder first_;
  Recorder second_;
};

TEST_F(RobotRuntimeTest, GivesEverySinkEverythingOnceAndThenItsEnd) {
  run();
  EXPECT_EQ(first_.frames, 60U);
  EXPECT_GT(first_.answers, 3U);
  EXPECT_EQ(first_.poses.size(), robot_.imu_samples());
  EXPECT_TRUE(std::ranges::is_sorted(first_.poses));
  EXPECT_EQ(first_.poses, second_.poses);
  EXPECT_EQ(first_.answers, second_.answers);
  EXPECT_EQ(first_.finished, 1);
  EXPECT_EQ(second_.finished, 1);
  EXPECT_FALSE(first_.interrupted);
}

TEST_F(RobotRuntimeTest, ReportsTheFaultsOfSensorsAndSinks) {
  run();
  EXPECT_EQ(sensors_.closed, 1);
  EXPECT_THAT(first_.faults_at_end, Contains(Pair("dropped_frames", 3U)));
  EXPECT_THAT(first_.faults_at_end, Contains(Pair("unpublished_poses", 4U)));
}

TEST_F(RobotRuntimeTest, FinishesTheSinksWhenItIsStopped) {
  std::stop_source stop;
  first_.on_output = [&] {
    if (first_.frames == 20) stop.request_stop();
  };
  run(stop.get_token());
  EXPECT_EQ(first_.frames, 20U);
  EXPECT_EQ(first_.finished, 1);
  EXPECT_TRUE(first_.interrupted);
}

TEST_F(RobotRuntimeTest, FinishesEverySinkThoughOneFailsAndPassesItsErrorOn) {
  first_.on_output = [&] {
    if (first_.frames >= 20) throw std::logic_error("no room");
  };
  EXPECT_THROW(run(), std::logic_error);
  EXPECT_EQ(first_.finished, 1);
  EXPECT_EQ(second_.finished, 1);
  EXPECT_TRUE(second_.interrupted);
}

TEST_F(RobotRuntimeTest, FinishesTheSinksWhenTheSensorsFailAndPassesTheErrorOn) {
  sensors_.failing_at = 100;
  EXPECT_THROW(run(), std::runtime_error);
  EXPECT_TRUE(first_.interrupted);
  EXPECT_EQ(sensors_.closed, 1);
  EXPECT_EQ(first_.finished, 1);
  EXPECT_EQ(second_.finished, 1);
}

}  // namespace
}  // namespace fleetloc
