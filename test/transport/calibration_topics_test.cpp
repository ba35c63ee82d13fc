// Calibration that comes on topics beside the images.
#include "robot/node/calibration_topics.hpp"

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "robot/node/sensor_topics.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/ros2/camera_info_codec.hpp"
#include "test/transport/driven_sensors.hpp"
#include "test/transport/ros2_network.hpp"
#include "test/transport/test_network.hpp"

namespace fleetloc {
namespace {

using namespace std::chrono_literals;

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
