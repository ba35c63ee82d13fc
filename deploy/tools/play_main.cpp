// fleetloc-play: a recording as topics of ROS 2.
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "deploy/config/default_config.hpp"
#include "deploy/play/player.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/option_check.hpp"
#include "shared/config/program.hpp"

namespace {

using namespace fleetloc;

constexpr const char* kDescription =
    "Publishes a recording in real time as the drivers of a stereo camera and an IMU would: "
    "sensor_msgs/Image (mono8) or CompressedImage (JPEG), Imu and, if --sensors names its topics, "
    "CameraInfo, as ROS 2 has them on the wire, over DDS and without ROS.\n\n"
    "It stays on this computer (loopback). Topics, their QoS and the domain are those of "
    "--sensors, the file that is given to fleetloc-robot, too; without it /camera/left/image_raw, "
    "/camera/right/image_raw and /imu in domain 0. Stamps are those of the recording, in each loop "
    "again: the clock is set back between them. Ctrl-C ends it.";

/// What the command line says that is not an option of the player as it stands.
struct Arguments {
  std::string sensors;
  std::string faults;
};

void add_options(CLI::App& app, PlayOptions& options, Arguments& arguments) {
  app.add_option("dataset", options.dataset, "recording: folder in the EuRoC/ASL layout")
      ->required();
  app.add_option("--sensors", arguments.sensors, "YAML of the robot that is to read the topics");
  app.add_option("--domain", options.domain, "DDS domain of ROS 2 (ROS_DOMAIN_ID), 0 to 100");
  app.add_option("--rate", options.rate, "speed, 1 if nothing is said")
      ->check(positive_up_to(kMaxRate));
  app.add_flag("--loop", options.loop, "from the start again, until it is stopped");
  app.add_option("--wait", options.wait_s, "seconds to wait for a reader of each topic")
      ->check(number_in(0.0, kLongest_s));
  app.add_option("--start", options.start_s, "seconds of the recording to skip")
      ->check(number_in(0.0, kLongest_s));
  app.add_option("--duration", options.duration_s, "seconds of the recording to play")
      ->check(positive_up_to(kLongest_s));
  app.add_option(
      "--faults", arguments.faults, "YAML: seed, and faults to inject (see robot/README.md)");
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    cv::setNumThreads(1);
    Program program("fleetloc-play", kDescription, default_config("everything"));
    PlayOptions options;
    Arguments arguments;
    add_options(program.options(), options, arguments);
    return program.run(argc, argv, [&] {
      auto termination = std::make_shared<Termination>();  // before any thread
      if (!arguments.sensors.empty()) options.sensors = arguments.sensors;
      if (!arguments.faults.empty()) {
        options.faults = read_fault_plan(ConfigReader::from_file(arguments.faults));
      }
      auto player = std::make_shared<Player>(options);
      return [player, termination] {
        player->run(termination->token());
        return static_cast<int>(kSuccess);
      };
    });
  });
}
