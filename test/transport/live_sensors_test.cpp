// A robot's sensors as topics of ROS 2, from the drivers' end to measurements.
#include "robot/node/live_sensors.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "deploy/play/sensor_publisher.hpp"
#include "robot/node/ros2_output.hpp"
#include "robot/node/sensor_topics.hpp"
#include "shared/ros2/camera_info_codec.hpp"
#include "shared/ros2/imu_codec.hpp"
#include "shared/ros2/pose_codec.hpp"
#include "shared/ros2/ros2_names.hpp"
#include "test/full_socket.hpp"
#include "test/transport/driven_sensors.hpp"
#include "test/transport/ros2_network.hpp"
#include "test/transport/test_network.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;

constexpr Duration kSecond = 1s;

SensorRig rig() {
  SensorRig rig;
  for (Camera* camera : {&rig.cameras.cam0, &rig.cameras.cam1}) {
    camera->width_px = kWidth;
    camera->height_px = kHeight;
  }
  return rig;
}

ImuSample imu_at(Duration time) {
  return {.stamp = Timestamp(kSecond + time), .specific_force = {0.0, 0.0, 9.81}};
}

StereoFrame frame_at(Duration time) {
  StereoFrame frame;
  frame.stamp = Timestamp(kSecond + time);
  frame.left = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(10));
  frame.right = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(20));
  return frame;
}

class LiveSensorsTest : public testing::Test {
 protected:
  /// After its publisher has found all its readers.
  void start() {
    live_.emplace(config_, rig(), robot_, log_.say());
    ASSERT_TRUE(comes_true([&] { return drivers_.has_readers(); }));
  }

  [[nodiscard]] std::uint64_t fault(const std::string& name) const {
    const auto faults = live_->faults();
    const auto found = faults.find(name);
    return found == faults.end() ? 0 : found->second;
  }

  const Ros2Network network_;
  SensorsConfig config_ = sensors(network_.domain());
  SensorPublisher drivers_{config_, rig().cameras};
  Ros2Participant robot_{network_.domain()};
  Log log_;
  std::optional<LiveSensors> live_;
};

TEST_F(LiveSensorsTest, GiveWhatTheDriversPublish) {
  start();
  drivers_.publish(imu_at(0ms));
  drivers_.publish(CameraFrame(frame_at(1ms)));
  drivers_.publish(imu_at(5ms));
  std::set<Duration> samples;
  std::optional<StereoFrame> frame;
  while (samples.size() < 2 || !frame) {
    const auto measurement = live_->next({});
    ASSERT_TRUE(measurement);
    if (const auto* sample = std::get_if<ImuSample>(&*measurement)) {
      samples.insert(sample->stamp.time_since_epoch());
    } else {
      frame = std::get<StereoFrame>(std::get<CameraFrame>(*measurement));
    }
  }
  EXPECT_EQ(samples, (std::set<Duration>{kSecond, kSecond + 5ms}));
  EXPECT_EQ(frame->stamp, Timestamp(kSecond + 1ms));
  EXPECT_EQ(cv::norm(frame->left, frame_at(1ms).left, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(frame->right, frame_at(1ms).right, cv::NORM_INF), 0.0);
}

TEST_F(LiveSensorsTest, AddTheTimeShiftOfTheCalibrationToImages) {
  SensorRig shifted = rig();
  shifted.camera_time_shift = 3ms;
  live_.emplace(config_, shifted, robot_, log_.say());
  ASSERT_TRUE(comes_true([&] { return drivers_.has_readers(); }));
  drivers_.publish(CameraFrame(frame_at(1ms)));
  drivers_.publish(imu_at(5ms));
  for (;;) {
    const auto measurement = live_->next({});
    ASSERT_TRUE(measurement);
    if (!std::holds_alternative<CameraFrame>(*measurement)) continue;
    EXPECT_EQ(stamp_of(*measurement), Timestamp(kSecond + 4ms));
    return;
  }
}

TEST_F(LiveSensorsTest, CountAndSayWhatCannotBeUsedAndGoOn) {
  Ros2Participant broken(network_.domain());
  Ros2Writer camera = broken.create_writer(image_topic(config_.left));
  start();
  ASSERT_TRUE(comes_true([&] { return camera.matched_readers() == 1; }));
  camera.write(Bytes{0, 1, 0, 0, 9, 9, 9});
  ImuSample infinite = imu_at(0ms);
  infinite.angular_velocity.x() = std::numeric_limits<double>::infinity();
  drivers_.publish(infinite);
  ASSERT_TRUE(comes_true([&] { return fault("images_undecodable") == 1; }));
  ASSERT_TRUE(comes_true([&] { return fault("imu_not_finite") == 1; }));
  ASSERT_TRUE(comes_true([&] { return log_.has("/imu: messages are not used: not_finite"); }));
  ASSERT_TRUE(comes_true([&] { return log_.has("/left: messages are not used: undecodable"); }));
  drivers_.publish(imu_at(5ms));
  const auto measurement = live_->next({});
  ASSERT_TRUE(measurement);
  EXPECT_EQ(stamp_of(*measurement), Timestamp(kSecond + 5ms));
}

TEST_F(LiveSensorsTest, GiveThePoseThatSomebodyTells) {
  Ros2Participant rviz(network_.domain());
  Ros2Writer writer = rviz.create_writer(initial_pose_topic(config_.initial_pose));
  start();
  ASSERT_TRUE(comes_true([&] { return writer.matched_readers() == 1; }));
  writer.write(Bytes{0, 1, 0, 0, 9, 9, 9});
  writer.write(encode(PoseMessage{.header = {.stamp = {}, .frame = "odom"}, .T_a_b = {}}));
  writer.write(encode(PoseMessage{.header = {.stamp = Timestamp(kSecond), .frame = "map"},
                                  .T_a_b = {.p = {1.0, 2.0, 0.0}}}));
  const auto measurement = live_->next({});
  ASSERT_TRUE(measurement);
  EXPECT_EQ(std::get<GivenPose>(*measurement).T_map_body.p, Eigen::Vector3d(1.0, 2.0, 0.0));
  EXPECT_EQ(fault("initial_pose_undecodable"), 1U);
  EXPECT_EQ(fault("initial_pose_in_another_frame"), 1U);
  EXPECT_TRUE(comes_true([&] { return log_.has("/initialpose: the robot is at (1.00, 2.00"); }));
}

TEST_F(LiveSensorsTest, SayWhichTopicIsSilentWhileNobodyTakesAnything) {
  config_.assembler.silence = 50ms;
  start();
  EXPECT_TRUE(comes_true([&] {
    return log_.has("/left: no message") && log_.has("/right: no message") &&
           log_.has("/imu: no message");
  }));
  EXPECT_THAT(live_->silent_topics(), Contains("/imu"));
}

TEST_F(LiveSensorsTest, SayWhichSettingToRaiseWhenTheKernelDropsDatagrams) {
  const FullSocket socket(network_.domain());
  start();
  ASSERT_TRUE(comes_true([&] { return log_.has("datagrams of ROS 2 were lost"); }));
  EXPECT_TRUE(log_.has("net.core.rmem_max") || log_.has("receiveBufferSize"));
  EXPECT_GT(fault("datagrams_without_room"), 0);
}

TEST_F(LiveSensorsTest, EndTheirWaitWhenAStopIsRequested) {
  start();
  std::stop_source stop;
  const std::jthread user([&] { stop.request_stop(); });
  EXPECT_FALSE(live_->next(stop.get_token()));
}

TEST_F(LiveSensorsTest, AreClosedWhileNothingComes) {
  start();
  EXPECT_EQ(live_->close().at("dropped_images"), 0);
}

TEST_F(LiveSensorsTest, GetNothingForAnImageThatIsMissing) {
  start();
  StereoFrame alone = frame_at(0ms);
  alone.right = cv::Mat();
  drivers_.publish(CameraFrame(alone));
  EXPECT_EQ(drivers_.counts().left, 1);
  EXPECT_EQ(drivers_.counts().right, 0);
}

TEST_F(LiveSensorsTest, AreNotPlayedAsRectifiedImages) {
  config_.calibration = CameraInfoSource{.left = {.name = "/left/info"},
                                         .right = {.name = "/right/info"},
                                         .images = ImageKind::kRectified};
  EXPECT_THROW((SensorPublisher{config_, rig().cameras}), ConfigError);
}

TEST(Ros2OutputTest, PublishesPosesOnceThereAreSome) {
  const Ros2Network network;
  Ros2Participant robot(network.domain());
  Ros2Participant viewer(network.domain());
  Ros2Output output(sensors(network.domain()), robot);
  const auto reliable = [](const char* name, const char* type) {
    return Ros2Subscription{{name, type, Ros2Qos::kDefault}, 10};
  };
  Ros2Reader reader(viewer,
                    {reliable("rt/odometry", ros2_type::kOdometry),
                     reliable("rt/map_pose", ros2_type::kPoseWithCovariance),
                     reliable("rt/tf", ros2_type::kTransforms)});
  ASSERT_TRUE(comes_true([&] {
    return reader.matched_writers(0) == 1 && reader.matched_writers(1) == 1 &&
           reader.matched_writers(2) == 1 && output.has_readers();
  }));
  RobotOutput out;
  out.pose.emplace();
  out.pose->stamp = Timestamp(kSecond);
  output.add(out);  // initializing
  out.pose->stamp += 5ms;
  out.pose->quality = Quality::kLocalized;
  out.pose->T_map_body = Pose{.p = {1.0, 2.0, 3.0}};
  out.frames = {FrameOutput{.stamp = out.pose->stamp, .pose = *out.pose}};
  output.add(out);
  std::array<int, 3> received{};
  for (int i = 0; i < 3; ++i) {
    const auto sample = reader.take({}, kPatience);
    ASSERT_TRUE(sample);
    ++received.at(sample->topic);
    if (sample->topic != 1) continue;
    const auto pose = decode_pose(sample->payload);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->header.frame, "map");
    EXPECT_EQ(pose->header.stamp, Timestamp(kSecond + 5ms));
    EXPECT_EQ(pose->T_a_b.p, Eigen::Vector3d(1.0, 2.0, 3.0));
  }
  EXPECT_THAT(received, testing::Each(1));
  EXPECT_THAT(output.faults(), testing::IsEmpty());
}

}  // namespace
}  // namespace fleetloc
