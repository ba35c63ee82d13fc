// fleetloc-cloud: a localizer with its laser map, over DDS.
#include <algorithm>
#include <memory>
#include <string>
#include <thread>

#include "cloud/node/cloud_node.hpp"
#include "cloud/node/default_config.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/option_check.hpp"
#include "shared/config/program.hpp"
#include "shared/core/ids.hpp"

namespace {

fleetloc::CloudNodeConfig read_config(fleetloc::ConfigReader config) {
  return {.pool = fleetloc::read_localizer_pool_config(config),
          .map_publisher = fleetloc::read_map_publisher_config(config.section("ros2"))};
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    using namespace fleetloc;
    Program program("fleetloc-cloud",
                    "Localizes the submaps of robots in a laser map, until SIGINT or SIGTERM.",
                    kDefaultConfig);
    CloudNodeOptions options;
    std::string link;
    std::string security;
    CLI::App& app = program.options();
    app.add_option("--map", options.map, "laser map, made by fleetloc-map")->required();
    app.add_option("--name", options.name, "1 to 32 of A-Z a-z 0-9 _ -")->required();
    app.add_option("--qos", options.qos, "QoS profiles, e.g. qos_profiles/lan.xml")->required();
    app.add_option(
        "--out", options.out, "folder for status.csv and sessions.json, is created; else neither");
    app.add_option("--domain", options.domain, "DDS domain, 0 to 100");
    options.workers = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 256U));
    app.add_option("--workers", options.workers, "localizations at a time, one for each core")
        ->capture_default_str()
        ->check(CLI::Range(1, 256));
    app.add_option("--link", link, "YAML: loss, delay and rate to emulate at this end");
    app.add_option("--security",
                   security,
                   "folder of its keys, made by deploy/security/fleet-keys.sh; --qos is a -secure "
                   "file then");
    app.add_option(
        "--monitor-qos",
        options.monitor_qos,
        "QoS profiles for fleetloc-monitor; else qos_profiles/monitor.xml as it was built");
    app.add_option(
           "--publish-map",
           options.publish_map_voxel_m,
           "shows the map to ROS 2 on this computer, a point for each voxel of this edge [m]")
        ->check(positive_up_to(100.0));
    return program.run(argc, argv, [&] {
      auto termination = std::make_shared<Termination>(Hangup::kReload);  // before any thread
      if (!is_valid_id(options.name)) {
        throw std::invalid_argument("--name: '" + options.name +
                                    "' is not 1 to 32 of A-Z a-z 0-9 _ -");
      }
      if (!link.empty()) options.link = read_link_file(link);
      if (!security.empty()) options.keys.emplace(security);
      auto node = std::make_shared<CloudNode>(
          options, read_config(program.config()), termination->reload());
      return [node, termination] {
        node->run(termination->token(), termination->urgent_token());
        return static_cast<int>(kSuccess);
      };
    });
  });
}
