// fleetloc-sim: what it writes, that it repeats itself, and what its command line refuses.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <map>
#include <thread>
#include <variant>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud/mapping/lidar_file.hpp"
#include "deploy/sim/motion/recorded_motion.hpp"
#include "robot/dataset/dataset_reader.hpp"
#include "shared/trajectory/tum_file.hpp"
#include "test/system/recorded_flight.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using Words = std::vector<std::string>;

const std::string kWorld = FLEETLOC_SOURCE_DIR "/deploy/worlds/campus.yaml";

class Simulation : public testing::Test {
 protected:
  Simulation() {
    std::ofstream(scratch_ / "route.yaml")
        << "speed_m_s: 1.2\nrest_s: 0.5\ncorner_radius_m: 3\nloop: false\nlaps: 1\n"
           "waypoints: [[0, 0], [4, 0], [8, 2]]\n";
    std::ofstream(scratch_ / "small.yaml")
        << "sim:\n  images: {rate_hz: 4}\n"
           "  cameras: {resolution_px: [160, 120], focal_px: 90}\n"
           "  lidar: {columns: 180}\n";
    std::ofstream cloud(scratch_ / "room.ply");
    constexpr int kSide = 60;
    cloud << "ply\nformat ascii 1.0\nelement vertex " << kSide * kSide
          << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        cloud << "3 " << 0.05 * row - 1.5 << ' ' << 0.05 * column - 1.5 << '\n';
      }
    }
    std::ofstream poses(scratch_ / "poses.tum");
    for (int i = 0; i <= 40; ++i) poses << 1000.0 + 0.05 * i << " 0 0 " << 0.01 * i << " 0 0 0 1\n";
    std::ofstream(scratch_ / "imu.csv") << "#anything at all\n1,2,3\n";
  }

  [[nodiscard]] std::string file(const std::string& name) const {
    return (scratch_ / name).string();
  }

  /// A drive of three seconds through the campus.
  [[nodiscard]] Words drive(const std::string& out, const Words& more = {}) const {
    Words words{"--scene",
                kWorld,
                "--route",
                file("route.yaml"),
                "--config",
                file("small.yaml"),
                "--duration",
                "3",
                "--out",
                file(out)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  [[nodiscard]] Words flight(const std::string& out, const Words& more = {}) const {
    Words words{"--cloud",
                file("room.ply"),
                "--trajectory",
                file("poses.tum"),
                "--config",
                file("small.yaml"),
                "--out",
                file(out)};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  const ScratchFolder scratch_;
};

void expect_refused(const Words& words, const std::string& culprit) {
  SCOPED_TRACE(testing::PrintToString(words));
  const Outcome outcome = run(FLEETLOC_SIM, words);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.output, "");
  EXPECT_THAT(outcome.errors, AllOf(StartsWith("fleetloc-sim: "), HasSubstr(culprit)));
  EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
}

/// Every file below the folder by its name there.
std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> result;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    result[entry.path().lexically_relative(folder)] = content_of(entry.path());
  }
  return result;
}

TEST_F(Simulation, WritesADatasetThatTheReadersPlay) {
  const Outcome outcome = run(FLEETLOC_SIM, drive("out", {"--lidar"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(outcome.errors, "");  // no progress in a pipe
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("route "), HasSubstr("13 stereo pairs, 30 lidar")));

  DatasetReader reader({.folder = scratch_ / "out"});
  EXPECT_EQ(*reader.frame_count(), 13U);
  std::size_t imu = 0;
  while (const auto item = reader.next()) imu += std::holds_alternative<ImuSample>(*item) ? 1U : 0U;
  EXPECT_EQ(imu, 601U);
  const auto mav0 = scratch_ / "out" / "mav0";
  EXPECT_EQ(read_trajectory(mav0 / "state_groundtruth_estimate0" / "data.csv").size(), 601U);
  const LidarReader lidar(mav0 / "lidar0");
  ASSERT_EQ(lidar.size(), 30U);
  EXPECT_GT(lidar.scan(7).points.size(), 500U);
  const Outcome map =
      run(FLEETLOC_MAP,
          {"build", "--cloud", mav0 / "pointcloud0" / "data.ply", "--out", file("map.pcd")});
  EXPECT_EQ(map.exit_code, 0) << map.errors;
}

TEST_F(Simulation, IsTheSameByteForByteWithAnyNumberOfThreads) {
  ASSERT_EQ(run(FLEETLOC_SIM, drive("one", {"--lidar", "--threads", "1"})).exit_code, 0);
  ASSERT_EQ(run(FLEETLOC_SIM, drive("three", {"--lidar", "--threads", "3"})).exit_code, 0);
  ASSERT_EQ(run(FLEETLOC_SIM, drive("other", {"--lidar", "--seed", "2"})).exit_code, 0);
  EXPECT_TRUE(contents(scratch_ / "one") == contents(scratch_ / "three"));
  EXPECT_FALSE(contents(scratch_ / "one") == contents(scratch_ / "other"));
}

/// Another drive along the first metres of a way.
void write_short_cut(const std::filesystem::path& file, const std::string& waypoints) {
  std::ofstream(file) << "speed_m_s: 0.8\nrest_s: 1\ncorner_radius_m: 3\nloop: false\nlaps: 1\n"
                      << "waypoints: " << waypoints << '\n';
}

TEST_F(Simulation, ShowsRobotsOfOneWorldTheSameStreets) {
  write_short_cut(scratch_ / "short.yaml", "[[0, 0], [3, 0]]");
  const auto first_image = [&](const std::string& out, Words words) {
    words.insert(words.begin(), {"--scene", kWorld, "--config", file("small.yaml")});
    words.insert(words.end(), {"--duration", "0.5", "--out", file(out)});
    const Outcome outcome = run(FLEETLOC_SIM, words);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    return content_of(scratch_ / out / "mav0" / "cam0" / "data" / "1000000000000.png");
  };
  const std::string whole = first_image("whole", {"--route", file("route.yaml")});
  const std::string same =
      first_image("same", {"--route", file("short.yaml"), "--built-along", file("route.yaml")});
  const std::string other = first_image("other", {"--route", file("short.yaml")});
  EXPECT_FALSE(whole.empty());
  EXPECT_TRUE(whole == same);
  EXPECT_FALSE(whole == other);
}

TEST_F(Simulation, RefusesARouteThatLeavesTheStreets) {
  write_short_cut(scratch_ / "beside.yaml", "[[0, 0], [3, 6]]");
  write_short_cut(scratch_ / "above.yaml", "[[0, 0, 2], [3, 0, 2]]");
  for (const std::string name : {"beside.yaml", "above.yaml"}) {
    const Outcome outcome = run(FLEETLOC_SIM,
                                {"--scene",
                                 kWorld,
                                 "--route",
                                 file(name),
                                 "--built-along",
                                 file("route.yaml"),
                                 "--out",
                                 file("out")});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors,
                AllOf(StartsWith("fleetloc-sim: " + file(name)),
                      HasSubstr("leaves the streets at x "),
                      HasSubstr(file("route.yaml"))));
    EXPECT_EQ(std::ranges::count(outcome.errors, '\n'), 1) << outcome.errors;
  }
}

TEST_F(Simulation, RendersACloudAlongARecordAndCopiesItsImu) {
  const Outcome outcome = run(FLEETLOC_SIM, flight("out", {"--imu", file("imu.csv")}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("residual"));
  const auto mav0 = scratch_ / "out" / "mav0";
  EXPECT_EQ(content_of(mav0 / "imu0" / "data.csv"), content_of(scratch_ / "imu.csv"));
  EXPECT_THAT(content_of(mav0 / "cam0" / "data.csv"), HasSubstr("1000250000000,"));
  const auto truth = read_trajectory(mav0 / "state_groundtruth_estimate0" / "data.csv");
  const auto middle =
      interpolate(truth, Timestamp(std::chrono::seconds(1001)), Duration(6'000'000));
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->p.z(), 0.2, 1e-4);
}

TEST_F(Simulation, WritesWhatItHasWhenItIsInterrupted) {
  std::ofstream(scratch_ / "small.yaml")
      << "sim:\n  images: {rate_hz: 2000}\n"
         "  cameras: {resolution_px: [160, 120], focal_px: 90}\n";
  ChildProgram program(FLEETLOC_SIM, drive("out"));
  const auto list = scratch_ / "out" / "mav0" / "cam0" / "data";
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!std::filesystem::exists(list) || std::filesystem::is_empty(list)) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    std::this_thread::yield();
  }
  program.signal(SIGINT);
  EXPECT_EQ(program.wait().exit_code, 1) << "half a dataset is none";
  const DatasetReader reader({.folder = scratch_ / "out"});
  EXPECT_GE(*reader.frame_count(), 1U);
  EXPECT_LT(*reader.frame_count(), 6000U);
}

TEST_F(Simulation, RefusesAWrongCommandLine) {
  expect_refused({}, "--out");
  expect_refused({"--out", file("out")}, "--scene");
  expect_refused({"--scene", kWorld, "--out", file("out")}, "--route");
  expect_refused({"--cloud", file("room.ply"), "--out", file("out")}, "--trajectory");
  expect_refused(drive("out", {"--cloud", file("room.ply"), "--trajectory", file("poses.tum")}),
                 "--cloud");
  expect_refused(drive("out", {"--no-such-option"}), "--no-such-option");
  expect_refused(drive("out", {"--season", "carnival"}), "carnival");
  expect_refused(drive("out", {"--threads", "0"}), "--threads");
  expect_refused(drive("out", {"--start", "9999"}), "--start");
  expect_refused(drive("out", {"--imu", file("imu.csv")}), "--trajectory");
  expect_refused(drive("out", {"--calibration", file("none")}), file("none"));
  expect_refused(flight("out", {"--imu", file("none.csv")}), "none.csv");
}

TEST_F(Simulation, RefusesWrongFilesByTheirNames) {
  std::ofstream(scratch_ / "wrong.yaml") << "sim:\n  no_such_key: 3\n";
  std::ofstream(scratch_ / "bad.yaml") << "waypoints: [[0, 0], [1]]\n";
  std::ofstream(scratch_ / "bad.tum") << "1000.0 0 0 0 0 0 0 1\n1000.1 0 0 zero 0 0 0 1\n";
  std::ofstream(scratch_ / "short.tum") << "1000.0 0 0 0 0 0 0 1\n";
  const auto with_route = [&](const std::string& route) {
    return Words{"--scene", kWorld, "--route", route, "--out", file("out")};
  };
  Words configured = with_route(file("route.yaml"));
  configured.insert(configured.end(), {"--config", file("wrong.yaml")});
  expect_refused(configured, file("wrong.yaml") + ":2: sim.no_such_key");
  expect_refused(with_route(file("none.yaml")), file("none.yaml"));
  expect_refused(with_route(file("bad.yaml")), file("bad.yaml"));
  expect_refused(with_route(file("bad.tum")), file("bad.tum") + ":2: 'zero'");
  expect_refused(with_route(file("short.tum")), file("short.tum"));
  expect_refused(
      {"--scene", file("none.yaml"), "--route", file("route.yaml"), "--out", file("out")},
      file("none.yaml"));
  expect_refused(
      {"--cloud", file("none.ply"), "--trajectory", file("poses.tum"), "--out", file("o")},
      file("none.ply"));
}

TEST_F(Simulation, DoesNotWriteIntoADataset) {
  std::filesystem::create_directories(scratch_ / "out" / "mav0");
  expect_refused(drive("out"), "there is a dataset already");
}

TEST(RecordedRoutes, AreFollowedWithinTheLimitsOfARobot) {
  const auto folder = recordings() / "yq";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "there are no routes in " << folder;
  const RecordFitConfig config{.knot_interval_s = 0.1,
                               .position_cutoff_hz = 0.6,
                               .rotation_cutoff_hz = 1.0,
                               .limits = {2.5, 1.5, 1.0, 2.0}};
  for (const auto& [name, residual_m] :
       {std::pair{"yq1_20170823.tum", 0.03}, {"yq4_20180129.tum", 0.05}}) {
    const RecordFit fit = fit_record(read_trajectory(folder / name), config);
    EXPECT_TRUE(fit.within_limits) << name;
    EXPECT_LT(fit.position_m.median, residual_m) << name;
    EXPECT_LT(fit.position_m.max, 0.4) << name;
    EXPECT_LT(fit.rotation_deg.median, 0.4) << name;
    EXPECT_LT(fit.greatest.acceleration, config.limits.acceleration) << name;
    std::cout << name << ": residual median " << fit.position_m.median << ", p95 "
              << fit.position_m.p95 << ", max " << fit.position_m.max << " m\n";
  }
}

}  // namespace
}  // namespace fleetloc
