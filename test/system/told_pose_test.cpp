// A live robot that is told where it is as RViz does it, and that remembers it for its next start.
#include <algorithm>
#include <csignal>
#include <fstream>
#include <iostream>
#include <limits>
#include <optional>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <idl/ros2/sensor_msgs.h>

#include "shared/geometry/pose_text.hpp"
#include "shared/ros2/pose_codec.hpp"
#include "shared/ros2/ros2_cdr.hpp"
#include "shared/ros2/ros2_names.hpp"
#include "shared/transport/ros2/ros2_participant.hpp"
#include "shared/transport/ros2/ros2_profiles.hpp"
#include "test/system/checked_frames.hpp"
#include "test/system/live_fixture.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;

constexpr const char* kRobot = "robot_1";
constexpr std::chrono::seconds kPatience{30};

class ToldPose : public LiveFixture {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
    DdsFixture::SetUp();
    describe_sensors();
    load_ros2_profiles();
    rviz_.emplace(static_cast<std::uint32_t>(std::stoi(ros_domain())));
  }

  void begin_robot() {
    Arguments arguments = live_robot_anywhere(kRobot);
    arguments.insert(arguments.end(), {"--last-pose", (scratch_ / "last_pose.yaml").string()});
    robot_.emplace(FLEETLOC_ROBOT, arguments);
  }

  /// Lets the robot fly a part of the flight, and ends it.
  /// @return what it said
  std::string flown(const std::string& start_s, const std::string& duration_s) {
    const Outcome played = run(FLEETLOC_PLAY,
                               {flight_.folder.string(),
                                "--sensors",
                                sensors_.string(),
                                "--start",
                                start_s,
                                "--duration",
                                duration_s,
                                "--wait",
                                "60"});
    robot_->signal(SIGTERM);
    const Outcome flown = robot_->wait();
    EXPECT_EQ(played.exit_code, 0) << played.errors;
    EXPECT_EQ(flown.exit_code, 0) << flown.errors;
    return flown.output;
  }

  void expect_localized_at_the_end() const {
    const auto frames = checked_frames(folder_of(kRobot), flight_);
    ASSERT_FALSE(frames.empty());
    EXPECT_EQ(frames.back().state, "localized");
    EXPECT_LT(worst_while_localized(frames), 0.15);
    std::cout << frames.size() << " frames in the map, " << worst_while_localized(frames)
              << " m at worst\n";
  }

  /// From the first image of what was played last to the first frame that is localized.
  double localized_after_s(double start_s) const {
    const auto frames = checked_frames(folder_of(kRobot), flight_);
    const auto first = std::ranges::find(frames, "localized", &CheckedFrame::state);
    if (first == frames.end()) return std::numeric_limits<double>::infinity();
    const double after_s = to_seconds(first->stamp - first_frame(flight_.folder, start_s));
    std::cout << "localized after " << after_s << " s\n";
    return after_s;
  }

  std::size_t points_of_the_map() {
    using Cloud = sensor_msgs::msg::dds_::PointCloud2_;
    const Ros2Topic topic{
        .name = "rt/map_points", .type = ros2_type::kPointCloud, .qos = Ros2Qos::kLatched};
    Ros2Reader reader(*rviz_, {{topic, 1}});
    const auto sample = reader.take({}, kPatience);
    if (!sample) return 0;
    const auto cloud = from_ros2_cdr<Cloud>(sample->payload);
    return cloud ? cloud->width() * cloud->height() : 0;
  }

  /// As its "2D Pose Estimate" does, but for the height.
  void tell(const Pose& T_map_body) {
    Ros2Writer writer = rviz_->create_writer({.name = "rt/initialpose",
                                              .type = ros2_type::kPoseWithCovariance,
                                              .qos = Ros2Qos::kDefault});
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (writer.matched_readers() == 0 && std::chrono::steady_clock::now() < deadline) {
      std::this_thread::yield();
    }
    ASSERT_EQ(writer.matched_readers(), 1);
    writer.write(encode(PoseMessage{.header = {.stamp = {}, .frame = "map"}, .T_a_b = T_map_body}));
    ASSERT_TRUE(writer.wait_for_acknowledgments(kPatience));
  }

  std::optional<Ros2Participant> rviz_;
  std::optional<ChildProgram> robot_;
};

TEST_F(ToldPose, StartsARobotAndItsNextRunInTheMapThatIsShown) {
  const std::filesystem::path cloud_config = scratch_ / "cloud.yaml";
  std::ofstream(cloud_config) << "ros2: {domain: " << ros_domain() << "}\n";
  Arguments localizer = cloud("localizer_1");
  localizer.insert(localizer.end(), {"--publish-map", "0.2", "--config", cloud_config.string()});
  ChildProgram pool(FLEETLOC_CLOUD, localizer);
  EXPECT_GT(points_of_the_map(), 1000U);

  begin_robot();
  tell(pose_from_text(flight_.displaced_start_pose()));
  const std::string told = flown("0", "10");
  EXPECT_THAT(told, HasSubstr("no last pose in"));
  EXPECT_THAT(told, HasSubstr("/initialpose: the robot is at ("));
  expect_localized_at_the_end();

  begin_robot();
  const std::string remembered = flown("10", "8");
  EXPECT_THAT(remembered, HasSubstr("starts from its last pose"));
  EXPECT_LT(localized_after_s(10.0), 5.0) << "it was begun anew where it stood";
  expect_localized_at_the_end();
}

}  // namespace
}  // namespace fleetloc
