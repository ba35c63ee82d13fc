// A robot's sensors as topics of ROS 2, from the drivers' end to measurements.
#include "robot/node/live_sensors.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <mutex>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "deploy/play/sensor_publisher.hpp"
#include "robot/node/calibration_topics.hpp"
#include "robot/node/ros2_output.hpp"
#include "robot/node/sensor_topics.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/ros2/camera_info_codec.hpp"
#include "shared/ros2/imu_codec.hpp"
#include "shared/ros2/pose_codec.hpp"
#include "shared/ros2/ros2_names.hpp"
#include "test/full_socket.hpp"
#include "test/transport/ros2_network.hpp"
#include "test/transport/test_network.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;
using testing::Contains;
using testing::HasSubstr;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr Duration kSecond = 1s;

SensorsConfig sensors(std::uint32_t domain) {
  SensorsConfig config;
  config.domain = static_cast<int>(domain);
  config.left.topic = {.name = "/left", .qos = TopicQos::kDefault};
  config.right.topic = {.name = "/right", .qos = TopicQos::kDefault};
  config.imu = {.name = "/imu", .qos = TopicQos::kDefault};
  return config;
}

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

/// What has been said, by any thread.
class Log {
 public:
  [[nodiscard]] LiveSensors::Say say() {
    return [this](const std::string& event) {
      const std::lock_guard lock(mutex_);
      events_.push_back(event);
    };
  }
  [[nodiscard]] std::vector<std::string> events() const {
    const std::lock_guard lock(mutex_);
    return events_;
  }
  [[nodiscard]] bool has(const std::string& part) const {
    return std::ranges::any_of(
        events(), [&](const std::string& event) { return event.find(part) != std::string::npos; });
  }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> events_;
};

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

/// Drivers that publish CameraInfo of a rectified pair, 0.1 m apart.
class CalibrationTopicsTest : public testing::Test {
 protected:
  CalibrationTopicsTest() {
    config_.calibration =
        CameraInfoSource{.left = {.name = "/left/camera_info", .qos = TopicQos::kDefault},
                         .right = {.name = "/right/camera_info", .qos = TopicQos::kDefault}};
    const auto& source = std::get<CameraInfoSource>(config_.calibration);
    left_.emplace(drivers_.create_writer(camera_info_topic(source.left)));
    right_.emplace(drivers_.create_writer(camera_info_topic(source.right)));
  }

  [[nodiscard]] static Bytes info(double baseline_m) {
    const Camera camera{.width_px = kWidth,
                        .height_px = kHeight,
                        .focal_px = {100.0, 100.0},
                        .center_px = {32.0, 24.0}};
    CameraInfoMessage message = camera_info(camera, {});
    message.P[3] = -100.0 * baseline_m;
    return encode(message);
  }

  const Ros2Network network_;
  SensorsConfig config_ = sensors(network_.domain());
  Ros2Participant drivers_{network_.domain()};
  Ros2Participant robot_{network_.domain()};
  std::optional<Ros2Writer> left_;
  std::optional<Ros2Writer> right_;
  Log log_;
};

TEST_F(CalibrationTopicsTest, WaitForBothCameras) {
  config_.assembler.silence = 50ms;
  const std::jthread driver([&](const std::stop_token& stop) {
    comes_true([&] {
      left_->write(info(0.0));
      return log_.has("/right/camera_info: no message");
    });
    comes_true([&] {
      right_->write(info(0.1));
      return stop.stop_requested();
    });
  });
  const auto rig = calibration_from_topics(config_, robot_, log_.say(), {});
  ASSERT_TRUE(rig);
  EXPECT_EQ(rig->cameras.cam0.width_px, kWidth);
  EXPECT_NEAR((rig->cameras.T_body_cam1.p - rig->cameras.T_body_cam0.p).norm(), 0.1, 1e-9);
}

TEST_F(CalibrationTopicsTest, SayWhatIsWrongWithAPair) {
  std::stop_source stop;
  const std::jthread driver([&] {
    comes_true([&] {
      left_->write(info(0.0));
      right_->write(info(0.0));
      return log_.has("CameraInfo of the pair is not used: baseline");
    });
    stop.request_stop();
  });
  EXPECT_FALSE(calibration_from_topics(config_, robot_, log_.say(), stop.get_token()));
}

// What fleetloc-play tells of a recording's cameras is what a robot takes them for.
TEST(CameraInfoOfAPair, TellsItsCalibration) {
  using Distortion = Camera::Distortion;
  for (const Distortion model : {Distortion::kRadialTangential, Distortion::kEquidistant}) {
    const auto camera = [&](double focal_px) {
      return Camera{.width_px = 752,
                    .height_px = 480,
                    .focal_px = {focal_px, focal_px + 1.0},
                    .center_px = {367.0, 248.0},
                    .distortion = model,
                    .coefficients = {-0.28, 0.07, 2e-4, 2e-5}};
    };
    const StereoCalibration pair{
        .cam0 = camera(458.0),
        .cam1 = camera(461.0),
        .T_body_cam0 = {.R = exp_so3({0.1, -0.2, 1.5}), .p = {-0.02, -0.06, 0.01}},
        .T_body_cam1 = {.R = exp_so3({0.12, -0.19, 1.48}), .p = {-0.02, 0.05, 0.02}}};
    const auto [left, right] = camera_info(pair);
    const auto told = stereo_calibration(whole_image_info(left).value(),
                                         whole_image_info(right).value(),
                                         ImageKind::kRaw,
                                         pair.T_body_cam0);
    ASSERT_TRUE(told);
    for (const auto& [told_one, one] :
         {std::pair(told->cam0, pair.cam0), std::pair(told->cam1, pair.cam1)}) {
      EXPECT_EQ(told_one.distortion, one.distortion);
      EXPECT_EQ(told_one.coefficients, one.coefficients);
      EXPECT_EQ(told_one.focal_px, one.focal_px);
      EXPECT_EQ(told_one.center_px, one.center_px);
    }
    const Pose error = inverse(told->T_body_cam1) * pair.T_body_cam1;
    EXPECT_NEAR(error.p.norm(), 0.0, 1e-9);
    EXPECT_NEAR(log_so3(error.R).norm(), 0.0, 1e-9);
  }
}

TEST(CameraInfoOfAnImage, IsOfTheWholeImageOnly) {
  const Camera camera{.width_px = kWidth, .height_px = kHeight};
  CameraInfoMessage message = camera_info(camera, {});
  EXPECT_TRUE(whole_image_info(message));
  message.region = {.x_px = 0, .y_px = 0, .width_px = kWidth, .height_px = kHeight};
  EXPECT_TRUE(whole_image_info(message));
  message.region.height_px = kHeight / 2;
  EXPECT_FALSE(whole_image_info(message));
  message.region = {};
  message.binning_x = 2;
  EXPECT_FALSE(whole_image_info(message));
}

}  // namespace
}  // namespace fleetloc
