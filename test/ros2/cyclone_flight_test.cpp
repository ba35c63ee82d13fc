// Cameras and IMU on Eclipse Cyclone DDS, the robot on Fast DDS, what it publishes read by Cyclone:
// all as nodes of ROS 2, in real time.
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/config/delimited_file.hpp"
#include "test/ros2/cyclone_fixture.hpp"
#include "test/ros2/recorded_topics.hpp"

namespace fleetloc {
namespace {

using ::testing::Each;
using ::testing::Field;
using ::testing::Ge;
using ::testing::HasSubstr;
using ::testing::Le;

constexpr const char* kRobot = "robot_1";
constexpr const char* kBufferLine = "their receive buffer";

struct FlightCase {
  const char* name;
  RecordedFlight (*flight)();
  double median_m;  ///< largest median error in the map
};
void PrintTo(const FlightCase& one, std::ostream* stream) {
  *stream << one.name;
}

/// What came out of a flight.
struct Flown {
  Outcome robot;
  nlohmann::json summary;
  std::vector<RecordedPose> odometry;
  std::vector<RecordedPose> map_pose;
  std::vector<RecordedPose> tf;
  std::map<Timestamp, double> published;  ///< pairs of images

  /// Share of the published pairs that the odometry has got.
  [[nodiscard]] double used_pairs() const {
    const auto& faults = summary.at("input_faults");
    const double used = summary.at("frames").get<double>() - faults.value("unpaired_images", 0.0);
    return used / static_cast<double>(published.size());
  }
  [[nodiscard]] std::uint64_t lost_datagrams() const {
    return summary.at("input_faults").value("datagrams_without_room", std::uint64_t{0});
  }
};

class CycloneFlight : public CycloneFixture, public testing::WithParamInterface<FlightCase> {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    flight_ = GetParam().flight();
    if (const auto reason = why_missing(flight_)) GTEST_SKIP() << *reason;
  }

  /// @param qos  reliable or best_effort, of driver and robot
  Flown fly(const std::string& qos, const std::string& duration_s) {
    describe_sensors(qos == "reliable" ? "default" : "sensor_data");
    const auto published = scratch_ / "published.csv";
    const auto heard = folder_of("heard");
    ChildProgram localizer(FLEETLOC_CLOUD, cloud("localizer_1"));
    ChildProgram recorder(CYCLONE_RECORDER, {ros_domain(), heard.string()});
    ChildProgram robot(FLEETLOC_ROBOT, live_robot(kRobot));
    const Outcome driver =
        run(CYCLONE_DRIVER,
            {flight_.folder.string(), ros_domain(), qos, duration_s, published.string()});
    EXPECT_EQ(driver.exit_code, 0) << driver.errors;
    Flown flown;
    flown.robot = ended(robot);
    const Outcome recorded = ended(recorder);
    EXPECT_EQ(recorded.exit_code, 0) << recorded.errors;
    EXPECT_EQ(flown.robot.exit_code, 0) << flown.robot.errors;
    flown.summary = parsed_json(folder_of(kRobot) / "summary.json");
    flown.odometry = recorded_poses(heard / "odometry.csv");
    flown.map_pose = recorded_poses(heard / "map_pose.csv");
    flown.tf = recorded_poses(heard / "tf.csv");
    flown.published = publication_times(published);
    std::cout << qos << ": " << 100.0 * flown.used_pairs() << " % of " << flown.published.size()
              << " pairs used, " << flown.lost_datagrams() << " datagrams lost in the buffer\n";
    return flown;
  }
};

double duration_s(const std::vector<RecordedPose>& poses) {
  return to_seconds(poses.back().stamp - poses.front().stamp);
}

void print_quantiles(const std::string& what, std::vector<double> values_s) {
  if (values_s.empty()) return;
  std::ranges::sort(values_s);
  const auto quantile = [&](double q) {
    return 1e3 * values_s[static_cast<std::size_t>(q * static_cast<double>(values_s.size() - 1))];
  };
  std::cout << std::fixed << std::setprecision(1) << what << ": p50 " << quantile(0.5)
            << " ms, p99 " << quantile(0.99) << " ms\n";
}

// From the driver's write of the left image to the receipt of the pose, in other processes.
void print_latencies(const Flown& flown) {
  std::vector<double> odometry;
  std::vector<double> map_pose;
  for (const RecordedPose& pose : flown.map_pose) {
    const auto at = flown.published.find(pose.stamp);
    if (at != flown.published.end()) map_pose.push_back(pose.received_s - at->second);
  }
  std::optional<Timestamp> latest;
  for (const RecordedPose& pose : flown.odometry) {
    auto at = flown.published.upper_bound(pose.stamp);
    if (at == flown.published.begin() || (--at)->first == latest) continue;
    latest = at->first;  // the first pose of this frame's stamp or after it
    odometry.push_back(pose.received_s - at->second);
  }
  print_quantiles("from an image to /map_pose of its stamp", map_pose);
  print_quantiles("from an image to the next /odometry", odometry);
}

/// Traces of the covariances of position and rotation: the same in any axes.
struct Traces {
  double position = 0.0;
  double rotation = 0.0;
};

Traces ros_traces(const RecordedPose& pose) {
  const auto diagonal = [&](std::size_t i) { return pose.covariance[7 * i]; };
  return {.position = diagonal(0) + diagonal(1) + diagonal(2),
          .rotation = diagonal(3) + diagonal(4) + diagonal(5)};
}

// As the robot itself has written them of T_map_body, rotation first.
std::map<Timestamp, Traces> own_traces(const std::filesystem::path& run) {
  std::map<Timestamp, Traces> traces;
  DelimitedFile file(run / "diagnostics.csv", ',');
  file.next();
  std::map<std::string, std::size_t, std::less<>> column;
  for (std::size_t i = 0; i < file.columns(); ++i) column.emplace(file.text(i), i);
  while (file.next()) {
    const auto at = [&](const char* name) {
      const auto text = file.text(column.at(name));
      return text.empty() || text == "nan" ? 0.0 : file.number(column.at(name));
    };
    traces[file.seconds(0)] = {.position = at("cm44") + at("cm55") + at("cm66"),
                               .rotation = at("cm11") + at("cm22") + at("cm33")};
  }
  return traces;
}

void expect_covariances_in_the_order_of_ros(const Flown& flown, const std::filesystem::path& run) {
  constexpr double kRelative = 1e-4;  // digits of the file
  const auto own = own_traces(run);
  std::size_t compared = 0;
  for (const RecordedPose& pose : flown.map_pose) {
    const auto at = own.find(pose.stamp);
    if (at == own.end()) continue;
    const Traces traces = ros_traces(pose);
    ASSERT_NEAR(traces.position, at->second.position, kRelative * at->second.position);
    ASSERT_NEAR(traces.rotation, at->second.rotation, kRelative * at->second.rotation);
    for (std::size_t i = 0; i < 6; ++i) {
      ASSERT_GT(pose.covariance[7 * i], 0.0);
      for (std::size_t j = 0; j < i; ++j) {
        ASSERT_NEAR(pose.covariance[6 * i + j], pose.covariance[6 * j + i], 1e-9);
      }
    }
    ++compared;
  }
  EXPECT_GE(compared, flown.map_pose.size() * 9 / 10);
}

// odom -> base_link at its rate, map -> odom at its own; their product is the pose in the map.
void expect_tf_of_rep_105(const Flown& flown) {
  std::map<Timestamp, Pose> odom_base;
  std::map<Timestamp, Pose> map_odom;
  for (const RecordedPose& one : flown.tf) {
    const bool is_map = one.frame == "map";
    EXPECT_EQ(one.frame + ">" + one.child_frame, is_map ? "map>odom" : "odom>base_link");
    (is_map ? map_odom : odom_base)[one.stamp] = one.T_frame_child;
  }
  EXPECT_NEAR(static_cast<double>(odom_base.size()), 50.0 * duration_s(flown.odometry), 25.0);
  EXPECT_NEAR(static_cast<double>(map_odom.size()), 10.0 * duration_s(flown.map_pose), 20.0);
  std::size_t compared = 0;
  for (const RecordedPose& pose : flown.map_pose) {
    const auto base = odom_base.lower_bound(pose.stamp);
    const auto odom = map_odom.lower_bound(pose.stamp);
    if (base == odom_base.end() || odom == map_odom.end()) continue;
    if (base->first - pose.stamp > std::chrono::milliseconds(20)) continue;
    const Pose T_map_base = odom->second * base->second;
    EXPECT_LT((T_map_base.p - pose.T_frame_child.p).norm(), 0.1);
    ++compared;
  }
  EXPECT_GT(compared, flown.map_pose.size() / 10);
}

nlohmann::json errors_of(const std::filesystem::path& estimate, const RecordedFlight& flight) {
  return nlohmann::json::parse(must_run(FLEETLOC_EVAL,
                                        {"--ground-truth",
                                         flight.ground_truth.string(),
                                         "--estimate",
                                         estimate.string(),
                                         "--align",
                                         "none",
                                         "--json"})
                                   .output);
}

TEST_P(CycloneFlight, ReliableSensorsOfAnotherVendorGiveItsNodesGoodPoses) {
  const Flown flown = fly("reliable", "25");
  EXPECT_THAT(flown.used_pairs(), Ge(0.99)) << flown.robot.errors << flown.summary;
  ASSERT_FALSE(flown.odometry.empty());
  ASSERT_FALSE(flown.map_pose.empty());
  print_latencies(flown);

  EXPECT_THAT(flown.odometry, Each(Field(&RecordedPose::frame, "odom")));
  EXPECT_THAT(flown.odometry, Each(Field(&RecordedPose::child_frame, "base_link")));
  EXPECT_THAT(flown.map_pose, Each(Field(&RecordedPose::frame, "map")));
  EXPECT_THAT(duration_s(flown.odometry), Ge(20.0));
  EXPECT_NEAR(static_cast<double>(flown.odometry.size()), 50.0 * duration_s(flown.odometry), 25.0);
  expect_covariances_in_the_order_of_ros(flown, folder_of(kRobot));
  expect_tf_of_rep_105(flown);
  const auto errors = errors_of(folder_of("heard") / "map_pose.tum", flight_);
  std::cout << "map pose: " << errors.dump() << '\n';
  EXPECT_THAT(errors.at("translation_m").at("median").get<double>(), Le(GetParam().median_m));
}

TEST_P(CycloneFlight, BestEffortIsSurvivedAndLossInTheBufferIsNamed) {
  const Flown flown = fly("best_effort", "12");
  print_latencies(flown);
  EXPECT_EQ(flown.lost_datagrams() > 0,
            flown.robot.errors.find(kBufferLine) != std::string::npos ||
                flown.robot.output.find(kBufferLine) != std::string::npos)
      << flown.robot.output << flown.robot.errors;
  const bool is_blameless = flown.used_pairs() >= 0.99 || flown.lost_datagrams() > 0;
  EXPECT_TRUE(is_blameless) << flown.summary;
}

INSTANTIATE_TEST_SUITE_P(Simulated,
                         CycloneFlight,
                         testing::Values(FlightCase{"Room", simulated_room, 0.04}),
                         [](const auto& one) { return std::string(one.param.name); });
INSTANTIATE_TEST_SUITE_P(Recorded,
                         CycloneFlight,
                         testing::Values(FlightCase{"Flight", vicon_room, 0.07}),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace fleetloc
