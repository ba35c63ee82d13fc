// fleetloc-robot: a robot with live sensors, or that plays a recording, over DDS.
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "robot/node/default_config.hpp"
#include "robot/node/robot_node.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/option_check.hpp"
#include "shared/config/program.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/geometry/pose_text.hpp"

namespace {

using namespace fleetloc;

RobotNodeConfig read_config(const ConfigReader& config) {
  ConfigReader reader = config;
  ConfigReader last_pose = reader.section("start").section("last_pose");
  return {.pipeline = read_robot_pipeline_config(config),
          .worker = read_keyframe_worker_config(config),
          .client = read_cloud_client_config(reader.section("client")),
          .last_pose = {.position_sigma_m = last_pose.positive("position_sigma_m"),
                        .yaw_sigma_rad = last_pose.positive("yaw_sigma_deg") * kRadPerDeg},
          .recording = read_run_parts(reader.section("recording"))};
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    cv::setNumThreads(1);  // the tracking is one thread's work, and the same in every run
    Program program("fleetloc-robot",
                    "Tracks a robot by its stereo images and IMU, live from topics of ROS 2 "
                    "(--sensors) or from a recording (--dataset), sends submaps to a localizer, "
                    "and fuses its answers into a pose at IMU rate.",
                    kDefaultConfig);
    RobotNodeOptions options;
    std::string initial_pose;
    std::string initial_sigma;
    std::string initial_region;
    std::string link;
    std::string security;
    double duration = 0.0;
    std::string encoding;
    CLI::App& app = program.options();
    app.add_option("--robot-id", options.id, "1 to 32 of A-Z a-z 0-9 _ -")->required();
    auto* sensors = app.add_option(
        "--sensors", options.sensors, "YAML: topics, calibration and frames of live sensors");
    app.add_option("--dataset", options.dataset, "or: a recording, folder in the EuRoC/ASL layout")
        ->excludes(sensors);
    app.add_flag("--tracks", options.tracks, "play the dataset's feature tracks, not its images")
        ->excludes(sensors);
    app.add_option("--qos", options.qos, "QoS profiles, e.g. qos_profiles/lan.xml")->required();
    app.add_option("--out", options.out, "run folder, is created; without it nothing is written");
    app.add_option("--domain", options.domain, "DDS domain of the fleet, 0 to 100");
    app.add_option("--rate", options.rate, "speed of the recording; 0: as fast as possible")
        ->check(number_in(0.0, kMaxRate))
        ->excludes(sensors);
    app.add_option("--start", options.start_s, "seconds of the recording to skip")
        ->check(number_in(0.0, kLongest_s))
        ->excludes(sensors);
    auto* limited = app.add_option("--duration", duration, "seconds of the recording to play")
                        ->check(positive_up_to(kLongest_s))
                        ->excludes(sensors);
    auto* start_pose =
        app.add_option("--initial-pose",
                       initial_pose,
                       "\"x y z qx qy qz qw\" of the body in the map at the first image [m]");
    auto* start_sigma =
        app.add_option("--initial-sigma", initial_sigma, "\"m deg\" of that pose, one sigma");
    auto* region = app.add_option("--initial-region",
                                  initial_region,
                                  "or: where it is at the first image, a region of the map by its "
                                  "name, or \"x y radius\" [m]")
                       ->excludes(start_pose)
                       ->excludes(start_sigma);
    app.add_option("--last-pose",
                   options.last_pose,
                   "file that keeps the pose, from which the next start begins without "
                   "--initial-pose or --initial-region");
    app.add_option("--encoding", encoding, "of the submaps; compact if nothing is said")
        ->check(CLI::IsMember({"compact", "full"}));
    app.add_option("--link", link, "YAML: loss, delay and rate to emulate at this end");
    app.add_option("--security",
                   security,
                   "folder of its keys, made by deploy/security/fleet-keys.sh; --qos is a -secure "
                   "file then");
    return program.run(argc, argv, [&] {
      auto termination = std::make_shared<Termination>(Hangup::kReload);  // before any thread
      if (!is_valid_id(options.id)) {
        throw std::invalid_argument("--robot-id: '" + options.id +
                                    "' is not 1 to 32 of A-Z a-z 0-9 _ -");
      }
      if (options.dataset.empty() && options.sensors.empty()) {
        throw std::invalid_argument("--sensors FILE or --dataset DIR is needed");
      }
      if (limited->count() > 0) options.duration_s = duration;
      if (start_pose->count() > 0) options.T_map_body = pose_from_text(initial_pose);
      if (region->count() > 0) options.region = start_region(initial_region);
      if (!link.empty()) options.link = read_link_file(link);
      if (!security.empty()) options.keys.emplace(security);
      ConfigReader config = program.config();
      if (!encoding.empty()) {
        config.overlay(ConfigReader::from_string("client: {uplink: {encoding: " + encoding + "}}",
                                                 "--encoding"));
      }
      if (start_sigma->count() > 0) config.overlay(start_sigma_config(initial_sigma));
      options.config = program.command_line() + config.text();
      auto node = std::make_shared<RobotNode>(options, read_config(config), termination->reload());
      return [node, termination] {
        node->run(termination->token());
        return static_cast<int>(kSuccess);
      };
    });
  });
}
