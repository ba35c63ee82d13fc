// cyclone_driver DATASET DOMAIN reliable|best_effort DURATION_S PUBLISHED.csv
// The drivers of a stereo camera and an IMU, as nodes of ROS 2 on Eclipse Cyclone DDS: publishes a
// recording in real time once all topics are read. PUBLISHED.csv: stamp [ns], and when its left
// image was handed to Cyclone (boot time [ns]), of each pair.
#include <chrono>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <cyclone/sensor_msgs.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "test/ros2/cyclone_entity.hpp"
#include "test/ros2/recorded_sensors.hpp"

namespace {

using namespace fleetloc;
using Clock = std::chrono::steady_clock;

constexpr dds_duration_t kPatience = DDS_SECS(60);

std_msgs_msg_dds__Header_ header(std::int64_t stamp_ns, std::string& frame) {
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  std_msgs_msg_dds__Header_ header{};
  header.stamp.sec = static_cast<std::int32_t>(stamp_ns / kPerSecond);
  header.stamp.nanosec = static_cast<std::uint32_t>(stamp_ns % kPerSecond);
  header.frame_id = frame.data();
  return header;
}

class Driver {
 public:
  Driver(std::uint32_t domain, RosQos qos, const std::string& published)
      : participant_(dds_create_participant(domain, nullptr, nullptr), "participant"),
        left_(writer(sensor_msgs_msg_dds__Image__desc, "/camera/left/image_raw", qos)),
        right_(writer(sensor_msgs_msg_dds__Image__desc, "/camera/right/image_raw", qos)),
        imu_(writer(sensor_msgs_msg_dds__Imu__desc, "/imu", qos)),
        published_(published) {}

  void wait_for_readers() const {
    for (const dds_entity_t writer : {left_, right_, imu_}) {
      checked(dds_set_status_mask(writer, DDS_PUBLICATION_MATCHED_STATUS), "status");
      const CycloneEntity waits(dds_create_waitset(participant_), "waitset");
      checked(dds_waitset_attach(waits, writer, 0), "waitset");
      if (checked(dds_waitset_wait(waits, nullptr, 0, kPatience), "waitset") == 0) {
        throw std::runtime_error("nobody reads the topics");
      }
      checked(dds_waitset_detach(waits, writer), "waitset");
    }
  }

  /// At the pace of the stamps. Images are read before their time comes.
  void play(const std::vector<RecordedSample>& samples) {
    const auto begin = Clock::now();
    const std::int64_t first_ns = stamp_ns(samples.front());
    for (const RecordedSample& sample : samples) {
      const auto due = begin + std::chrono::nanoseconds(stamp_ns(sample) - first_ns);
      if (const auto* imu = std::get_if<RecordedImu>(&sample)) {
        std::this_thread::sleep_until(due);
        publish(*imu);
      } else {
        const auto& pair = std::get<RecordedPair>(sample);
        const cv::Mat left = cv::imread(pair.left.string(), cv::IMREAD_GRAYSCALE);
        const cv::Mat right = cv::imread(pair.right.string(), cv::IMREAD_GRAYSCALE);
        std::this_thread::sleep_until(due);
        published_ << pair.stamp_ns << ',' << boot_time_ns() << '\n';
        publish(left_, "cam0", pair.stamp_ns, left);
        publish(right_, "cam1", pair.stamp_ns, right);
      }
    }
  }

  /// Until reliable readers have everything.
  void finish() const {
    for (const dds_entity_t writer : {left_, right_, imu_}) {
      if (dds_wait_for_acks(writer, DDS_SECS(2)) != DDS_RETCODE_OK) {
        std::cerr << "a reader has not acknowledged everything\n";
      }
    }
  }

 private:
  dds_entity_t writer(const dds_topic_descriptor_t& type, const std::string& name, RosQos qos) {
    return ros_writer(participant_, ros_topic(participant_, type, name), qos);
  }

  void publish(const RecordedImu& sample) const {
    std::string frame = "imu0";
    sensor_msgs_msg_dds__Imu_ message{};
    message.header = header(sample.stamp_ns, frame);
    message.orientation.w = 1.0;
    message.orientation_covariance[0] = -1.0;  // is not measured
    message.angular_velocity = {sample.values[0], sample.values[1], sample.values[2]};
    message.linear_acceleration = {sample.values[3], sample.values[4], sample.values[5]};
    checked(dds_write(imu_, &message), "/imu");
  }

  static void publish(dds_entity_t writer,
                      std::string frame,
                      std::int64_t stamp_ns,
                      const cv::Mat& image) {
    if (image.empty() || !image.isContinuous()) throw std::runtime_error("an image is not there");
    std::string encoding = "mono8";
    sensor_msgs_msg_dds__Image_ message{};
    message.header = header(stamp_ns, frame);
    message.height = static_cast<std::uint32_t>(image.rows);
    message.width = static_cast<std::uint32_t>(image.cols);
    message.encoding = encoding.data();
    message.step = message.width;
    message.data._buffer = image.data;
    message.data._length = message.data._maximum = static_cast<std::uint32_t>(image.total());
    checked(dds_write(writer, &message), frame);
  }

  CycloneEntity participant_;
  dds_entity_t left_;
  dds_entity_t right_;
  dds_entity_t imu_;
  std::ofstream published_;
};

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 6) throw std::runtime_error("needs 5 arguments, see its source");
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    const auto samples = recorded_sensors(arguments[0], std::stod(arguments[3]));
    const RosQos qos = arguments[2] == "reliable" ? RosQos::kDefault : RosQos::kSensorData;
    Driver driver(static_cast<std::uint32_t>(std::stoul(arguments[1])), qos, arguments[4]);
    driver.wait_for_readers();
    driver.play(samples);
    driver.finish();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "cyclone_driver: " << error.what() << '\n';
    return 1;
  }
}
