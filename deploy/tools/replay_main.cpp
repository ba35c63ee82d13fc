// fleetloc-replay: robot, link and cloud in one process and in simulated time.
#include <algorithm>
#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "deploy/config/default_config.hpp"
#include "deploy/replay/replay.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/option_check.hpp"
#include "shared/config/program.hpp"
#include "shared/geometry/pose_text.hpp"

namespace {

constexpr double kMaxLatency_s = 3600.0;
constexpr double kMaxBandwidth = 1e12;  // [bytes/s]

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
    direction.queue_bytes = default_queue_bytes(direction);
  }
}

LinkConfig link_config(const LinkArguments& arguments) {
  LinkConfig link = arguments.file.empty() ? perfect_link() : read_link_file(arguments.file);
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

/// What the command line says that is not an option of the replay as it stands.
struct Arguments {
  LinkArguments link;
  std::string map;
  std::optional<std::string> initial_pose;
  std::optional<std::string> initial_sigma;
  std::optional<std::string> initial_region;
  std::string faults;
  std::string localizers;
  std::string encoding;
  std::string baseline;
  std::optional<double> duration_s;
  std::optional<int> window;
};

/// The configuration of the program, with the options of the command line. The robot remembers as
/// many keyframes as the cloud's window has, up to its own limit.
ConfigReader effective(const Program& program, const Arguments& arguments) {
  constexpr int kMaxRemembered = 64;
  ConfigReader config = program.config();
  if (arguments.window) {
    const int remembered = std::min(*arguments.window, kMaxRemembered);
    config.overlay(ConfigReader::from_string(
        "localizer: {window: " + std::to_string(*arguments.window) + "}\n" +
            "client: {uplink: {keyframes: " + std::to_string(remembered) + "}}",
        "--window"));
  }
  if (!arguments.encoding.empty()) {
    config.overlay(ConfigReader::from_string(
        "client: {uplink: {encoding: " + arguments.encoding + "}}", "--encoding"));
  }
  if (arguments.initial_sigma) config.overlay(start_sigma_config(*arguments.initial_sigma));
  return config;
}

void add_link_options(CLI::App& app, LinkArguments& link) {
  auto* seed = app.add_option("--seed", link.seed, "of the link's losses")->check(whole_number());
  app.add_option("--link", link.file, "YAML: seed, uplink and downlink")->excludes(seed);
  app.add_option("--loss", link.loss, "probability per datagram")->check(number_in(0.0, 1.0));
  app.add_option("--latency", link.latency_s, "one way [s]")->check(number_in(0.0, kMaxLatency_s));
  app.add_option("--bandwidth", link.bandwidth_bytes_per_s, "[bytes/s]; 0: unlimited")
      ->check(number_in(0.0, kMaxBandwidth));
  app.add_option("--direction", link.direction, "that loss, latency and bandwidth apply to")
      ->check(CLI::IsMember({"up", "down", "both"}));
}

void add_options(CLI::App& app, ReplayOptions& options, Arguments& arguments) {
  app.add_option("--dataset", options.dataset, "folder in the EuRoC/ASL layout")->required();
  app.add_option("--out", options.out, "run folder, is created")->required();
  app.add_option("--map", arguments.map, "laser map, made by fleetloc-map");
  auto* pose =
      app.add_option("--initial-pose",
                     arguments.initial_pose,
                     "\"x y z qx qy qz qw\" of the body in the map at the first image [m]");
  auto* sigma = app.add_option(
      "--initial-sigma", arguments.initial_sigma, "\"m deg\" of that pose, one sigma");
  app.add_option("--initial-region",
                 arguments.initial_region,
                 "or: where it is at the first image, a region of the map by its name, or "
                 "\"x y radius\" [m]")
      ->excludes(pose)
      ->excludes(sigma);
  app.add_option("--start", options.start_s, "seconds of the recording to skip")
      ->check(number_in(0.0, kLongest_s));
  app.add_option("--duration", arguments.duration_s, "seconds of the recording to play")
      ->check(positive_up_to(kLongest_s));
  app.add_option("--window", arguments.window, "keyframes in the cloud's window")
      ->check(CLI::Range(2, 1000));
  app.add_option("--encoding", arguments.encoding, "of the submaps; compact if nothing is said")
      ->check(CLI::IsMember({"compact", "full"}));
  app.add_flag("--align-once",
               options.align_once,
               "a control: fuse the first answer and dead-reckon after it");
  app.add_option("--baseline",
                 arguments.baseline,
                 "in place of link and cloud: each submap aligned by itself (icp: PCL's)")
      ->check(CLI::IsMember({"icp"}));
  app.add_flag("--tracks", options.tracks, "play the dataset's feature tracks, not its images");
  app.add_option("--faults", arguments.faults, "YAML: seed, and faults to inject while reading");
  app.add_option(
      "--samples", options.samples, "file for what the robot sends and gets: topic and bytes");
  app.add_option("--localizers", arguments.localizers, "YAML: which start, stop or die, and when");
  add_link_options(app, arguments.link);
}

void complete(ReplayOptions& options, const Arguments& arguments) {
  if (!arguments.map.empty()) options.map = arguments.map;
  options.duration_s = arguments.duration_s;
  if (arguments.initial_pose) options.T_map_body = pose_from_text(*arguments.initial_pose);
  if (arguments.initial_region) options.region = start_region(*arguments.initial_region);
  options.link = link_config(arguments.link);
  options.icp_baseline = !arguments.baseline.empty();
  if (!arguments.faults.empty()) {
    options.faults = read_fault_plan(ConfigReader::from_file(arguments.faults));
  }
  if (!arguments.localizers.empty()) {
    options.localizers = read_localizer_plan(ConfigReader::from_file(arguments.localizers));
  }
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
    Arguments arguments;
    add_options(program.options(), options, arguments);
    return program.run(argc, argv, [&] {
      auto termination = std::make_shared<Termination>();  // before any thread
      complete(options, arguments);
      const ConfigReader config = effective(program, arguments);
      options.config = program.command_line() + config.text();
      return [replay = prepared_replay(options, read_config(config)), termination] {
        replay(termination->token());
        return static_cast<int>(kSuccess);
      };
    });
  });
}
