// cyclone_recorder DOMAIN OUT [reliable|best_effort]
// A node of ROS 2 on Eclipse Cyclone DDS that writes what it hears to the folder OUT, until
// SIGTERM. All times are in ns; "received" is boot time. Columns:
//   odometry.csv, map_pose.csv: received, stamp, frame, child frame, x y z [m], qx qy qz qw, 36 of
//     the covariance
//   tf.csv: the same without a covariance
//   images.csv: received, stamp, frame, topic, width, height, step, encoding, bytes, FNV-1a of them
//   imu.csv: received, stamp, frame, -, angular velocity, specific force
//   map_pose.tum: poses of map_pose.csv for fleetloc-eval
// Images and IMU are only read if it is said how.
#include <array>
#include <atomic>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <iostream>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <cyclone/nav_msgs.h>
#include <cyclone/sensor_msgs.h>
#include <cyclone/tf2_msgs.h>
#include <unistd.h>

#include "test/ros2/cyclone_entity.hpp"

namespace {

using namespace fleetloc;

std::uint64_t fnv1a(std::span<const std::uint8_t> bytes) {
  std::uint64_t hash = 14695981039346656037U;
  for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 1099511628211U;
  return hash;
}

std::int64_t stamp_ns(const std_msgs_msg_dds__Header_& header) {
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  return header.stamp.sec * kPerSecond + header.stamp.nanosec;
}

template <typename Position>
void write_pose(std::ostream& out,
                const Position& p,
                const geometry_msgs_msg_dds__Quaternion_& q,
                char separator) {
  for (const double value : {p.x, p.y, p.z, q.x, q.y, q.z}) out << value << separator;
  out << q.w;
}

class Recorder {
 public:
  Recorder(std::uint32_t domain, const std::filesystem::path& folder)
      : participant_(dds_create_participant(domain, nullptr, nullptr), "participant"),
        folder_(made(folder)),
        waits_(dds_create_waitset(participant_), "waitset"),
        stop_(dds_create_guardcondition(participant_), "guard condition") {
    checked(dds_waitset_attach(waits_, stop_, 0), "waitset");
    listen<nav_msgs_msg_dds__Odometry_>(
        nav_msgs_msg_dds__Odometry__desc, "/odometry", RosQos::kDefault, [this](const auto& one) {
          add(odometry_, one.header, one.child_frame_id, one.pose);
        });
    listen<geometry_msgs_msg_dds__PoseWithCovarianceStamped_>(
        geometry_msgs_msg_dds__PoseWithCovarianceStamped__desc,
        "/map_pose",
        RosQos::kDefault,
        [this](const auto& one) { add_map_pose(one); });
    listen<tf2_msgs_msg_dds__TFMessage_>(
        tf2_msgs_msg_dds__TFMessage__desc, "/tf", RosQos::kDefault, [this](const auto& one) {
          add(one);
        });
  }

  void listen_to_sensors(RosQos qos) {
    for (const std::string topic : {"/camera/left/image_raw", "/camera/right/image_raw"}) {
      listen<sensor_msgs_msg_dds__Image_>(
          sensor_msgs_msg_dds__Image__desc, topic, qos, [this, topic](const auto& image) {
            add(topic, image);
          });
    }
    listen<sensor_msgs_msg_dds__Imu_>(
        sensor_msgs_msg_dds__Imu__desc, "/imu", qos, [this](const auto& sample) { add(sample); });
  }

  /// Until stop().
  void run() {
    std::array<dds_attach_t, 8> triggered{};
    for (;;) {
      const auto count = checked(
          dds_waitset_wait(waits_, triggered.data(), triggered.size(), DDS_INFINITY), "waitset");
      for (const dds_attach_t which : std::span(triggered).first(static_cast<std::size_t>(count))) {
        if (which == 0) return;
        takers_.at(static_cast<std::size_t>(which - 1))();
      }
    }
  }

  void stop() { dds_set_guardcondition(stop_, true); }

 private:
  template <typename Message>
  void listen(const dds_topic_descriptor_t& type,
              const std::string& topic,
              RosQos qos,
              std::function<void(const Message&)> use) {
    const dds_entity_t reader = ros_reader(participant_, ros_topic(participant_, type, topic), qos);
    checked(dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS), topic);
    takers_.push_back([reader, use = std::move(use)] {
      for (;;) {
        void* sample = nullptr;  // lent by Cyclone
        dds_sample_info_t info{};
        if (checked(dds_take(reader, &sample, &info, 1, 1), "take") == 0) return;
        if (info.valid_data) use(*static_cast<const Message*>(sample));
        dds_return_loan(reader, &sample, 1);
      }
    });
    checked(dds_waitset_attach(waits_, reader, static_cast<dds_attach_t>(takers_.size())), topic);
  }

  static std::filesystem::path made(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    return folder;
  }

  std::ofstream file(const std::string& name) const {
    std::ofstream stream(folder_ / name);
    stream << std::setprecision(17);
    return stream;
  }

  static void begin_line(std::ostream& out,
                         const std_msgs_msg_dds__Header_& header,
                         const std::string& child) {
    out << boot_time_ns() << ',' << stamp_ns(header) << ',' << header.frame_id << ',' << child
        << ',';
  }

  static void add(std::ostream& out,
                  const std_msgs_msg_dds__Header_& header,
                  const std::string& child,
                  const geometry_msgs_msg_dds__PoseWithCovariance_& pose) {
    begin_line(out, header, child);
    write_pose(out, pose.pose.position, pose.pose.orientation, ',');
    for (const double value : pose.covariance) out << ',' << value;
    out << '\n';
  }

  void add_map_pose(const geometry_msgs_msg_dds__PoseWithCovarianceStamped_& message) {
    add(map_pose_, message.header, "", message.pose);
    tum_ << message.header.stamp.sec << '.' << std::setw(9) << std::setfill('0')
         << message.header.stamp.nanosec << ' ';
    write_pose(tum_, message.pose.pose.position, message.pose.pose.orientation, ' ');
    tum_ << '\n';
  }

  void add(const tf2_msgs_msg_dds__TFMessage_& message) {
    for (const auto& one : std::span(message.transforms._buffer, message.transforms._length)) {
      begin_line(tf_, one.header, one.child_frame_id);
      write_pose(tf_, one.transform.translation, one.transform.rotation, ',');
      tf_ << '\n';
    }
  }

  void add(const std::string& topic, const sensor_msgs_msg_dds__Image_& image) {
    const std::span data(image.data._buffer, image.data._length);
    images_ << boot_time_ns() << ',' << stamp_ns(image.header) << ',' << image.header.frame_id
            << ',' << topic << ',' << image.width << ',' << image.height << ',' << image.step << ','
            << image.encoding << ',' << data.size() << ',' << fnv1a(data) << '\n';
  }

  void add(const sensor_msgs_msg_dds__Imu_& sample) {
    begin_line(imu_, sample.header, "");
    const auto& w = sample.angular_velocity;
    const auto& f = sample.linear_acceleration;
    imu_ << w.x << ',' << w.y << ',' << w.z << ',' << f.x << ',' << f.y << ',' << f.z << '\n';
  }

  CycloneEntity participant_;
  std::filesystem::path folder_;
  CycloneEntity waits_;
  CycloneEntity stop_;
  std::vector<std::function<void()>> takers_;  // by the reader's number, from 1
  std::ofstream odometry_ = file("odometry.csv");
  std::ofstream map_pose_ = file("map_pose.csv");
  std::ofstream tf_ = file("tf.csv");
  std::ofstream images_ = file("images.csv");
  std::ofstream imu_ = file("imu.csv");
  std::ofstream tum_ = file("map_pose.tum");
};

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 3) throw std::runtime_error("needs 2 arguments, see its source");
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    sigset_t end{};
    sigemptyset(&end);
    sigaddset(&end, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &end, nullptr);  // before any thread
    Recorder recorder(static_cast<std::uint32_t>(std::stoul(arguments[0])), arguments[1]);
    if (arguments.size() > 2) {
      recorder.listen_to_sensors(arguments[2] == "reliable" ? RosQos::kDefault
                                                            : RosQos::kSensorData);
    }
    std::atomic<bool> failed = false;
    {
      const std::jthread recording([&] {
        try {
          recorder.run();
        } catch (const std::exception& error) {
          std::cerr << "cyclone_recorder: " << error.what() << '\n';
          failed = true;
          kill(getpid(), SIGTERM);
        }
      });
      int signal = 0;
      sigwait(&end, &signal);
      recorder.stop();
    }
    return failed ? 1 : 0;
  } catch (const std::exception& error) {
    std::cerr << "cyclone_recorder: " << error.what() << '\n';
    return 1;
  }
}
