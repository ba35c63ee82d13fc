// fleetloc-replay: robot, link and cloud in one process and in simulated time.
#include <algorithm>
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "deploy/config/default_config.hpp"
#include "deploy/replay/replay.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/program.hpp"
#include "shared/geometry/pose_text.hpp"

namespace {

using namespace fleetloc;

/// Options of the link, beside or instead of a file.
struct LinkArguments {
  std::string file;
  double loss = 0.0;
  double latency_s = 0.0;
  double bandwidth_bytes_per_s = 0.0;
  std::string direction = "both";
  std::uint64_t seed = 1;
};

void apply(const LinkArguments& arguments, LinkDirection& direction) {
  direction.loss = std::max(direction.loss, arguments.loss);
  direction.delay_s += arguments.latency_s;
  if (arguments.bandwidth_bytes_per_s > 0.0) {
    direction.rate_bytes_per_s = arguments.bandwidth_bytes_per_s;
    constexpr double kQueueSeconds = 2.0;  // of the bottleneck
    direction.queue_bytes = std::max<std::size_t>(
        8000, static_cast<std::size_t>(kQueueSeconds * arguments.bandwidth_bytes_per_s));
  }
}

LinkConfig link_config(const LinkArguments& arguments) {
  LinkConfig link = arguments.file.empty()
                        ? perfect_link()
                        : read_link_config(ConfigReader::from_file(arguments.file));
  if (arguments.file.empty()) link.seed = arguments.seed;
  if (arguments.direction != "down") apply(arguments, link.uplink);
  if (arguments.direction != "up") apply(arguments, link.downlink);
  return link;
}

ReplayConfig read_config(const ConfigReader& config) {
  ConfigReader reader = config;
  ConfigReader durations = reader.section("replay");
  return {.pipeline = read_robot_pipeline_config(config),
          .worker = read_keyframe_worker_config(config),
          .client = read_cloud_client_config(reader.section("client")),
          .pool = read_localizer_pool_config(config),
          .icp = read_icp_localizer_config(reader.section("icp_baseline")),
          .durations = {.back_end_s = durations.positive("back_end_s"),
                        .localization_s = durations.positive("localization_s")}};
}

/// The configuration of the program, with the options of the command line.
ConfigReader effective(const Program& program, std::optional<int> window) {
  ConfigReader config = program.config();
  if (window) {
    config.overlay(ConfigReader::from_string("localizer: {window: " + std::to_string(*window) + "}",
                                             "--window"));
  }
  return config;
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    cv::setNumThreads(1);  // the same bits in every run
    Program program(
        "fleetloc-replay",
        "Runs a recording through robot, link and cloud in one process and in simulated "
        "time. Without --map: odometry only.",
        default_config("everything"));
    ReplayOptions options;
    LinkArguments link;
    std::string map;
    std::string initial_pose;
    std::string faults;
    std::string encoding = "full";
    std::string baseline;
    double duration = 0.0;
    int window = 0;
    CLI::App& app = program.options();
    app.add_option("--dataset", options.dataset, "folder in the EuRoC/ASL layout")->required();
    app.add_option("--out", options.out, "run folder, is created")->required();
    app.add_option("--map", map, "laser map, made by fleetloc-map");
    auto* start_pose =
        app.add_option("--initial-pose",
                       initial_pose,
                       "\"x y z qx qy qz qw\" of the body in the map at the first image [m]");
    app.add_option("--start", options.start_s, "seconds of the recording to skip")
        ->check(CLI::NonNegativeNumber);
    auto* limited = app.add_option("--duration", duration, "seconds of the recording to play")
                        ->check(CLI::PositiveNumber);
    auto* seed = app.add_option("--seed", link.seed, "of the link's losses");
    auto* windowed = app.add_option("--window", window, "keyframes in the cloud's window")
                         ->check(CLI::Range(2, 1000));
    app.add_option("--encoding", encoding, "encoding of the submaps")
        ->check(CLI::IsMember({"full"}));
    app.add_flag("--align-once",
                 options.align_once,
                 "a control: fuse the first answer and dead-reckon after it");
    app.add_option("--baseline",
                   baseline,
                   "in place of link and cloud: each submap aligned by itself (icp: PCL's)")
        ->check(CLI::IsMember({"icp"}));
    app.add_flag("--tracks", options.tracks, "play the dataset's feature tracks, not its images");
    app.add_option("--faults", faults, "YAML: seed, and faults to inject while reading");
    app.add_option("--link", link.file, "YAML: seed, uplink and downlink")->excludes(seed);
    app.add_option("--loss", link.loss, "probability per datagram")->check(CLI::Range(0.0, 1.0));
    app.add_option("--latency", link.latency_s, "one way [s]")->check(CLI::NonNegativeNumber);
    app.add_option("--bandwidth", link.bandwidth_bytes_per_s, "[bytes/s]; 0: unlimited")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--direction", link.direction, "that loss, latency and bandwidth apply to")
        ->check(CLI::IsMember({"up", "down", "both"}));
    return program.run(argc, argv, [&] {
      auto termination = std::make_shared<Termination>();  // before any thread
      if (!map.empty()) options.map = map;
      if (limited->count() > 0) options.duration_s = duration;
      if (start_pose->count() > 0) options.T_map_body = pose_from_text(initial_pose);
      options.link = link_config(link);
      options.icp_baseline = !baseline.empty();
      if (!faults.empty()) options.faults = read_fault_plan(ConfigReader::from_file(faults));
      const ConfigReader config =
          effective(program, windowed->count() > 0 ? std::optional(window) : std::nullopt);
      options.config = program.command_line() + config.text();
      return [replay = prepared_replay(options, read_config(config)), termination] {
        replay(termination->token());
        return static_cast<int>(kSuccess);
      };
    });
  });
}
