#include "deploy/evaluation/experiment/player.hpp"

#include <algorithm>
#include <chrono>
#include <optional>

#include "deploy/evaluation/experiment/initial_pose.hpp"
#include "deploy/process/child_process.hpp"
#include "shared/core/exact_text.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr std::chrono::seconds kGrace(10);

/// The truth at the first frame, displaced; a file holds it afterwards.
std::string start_pose(const Run& run,
                       const RunContext& context,
                       const fs::path& folder,
                       const std::stop_token& stop) {
  const Input& dataset = context.inputs->dataset(run.dataset->name);
  const fs::path mav0 =
      fs::is_directory(dataset.path / "mav0") ? dataset.path / "mav0" : dataset.path;
  const fs::path index = mav0 / (run.dataset->plays_tracks() ? "tracks0" : "cam0") / "data.csv";
  const Timestamp stamp = first_frame(index, run.start_s);
  std::string displacement;
  for (const double value : start_displacement(context.plan->start_error, run.seed)) {
    displacement += (displacement.empty() ? "" : " ") + exact_text(value);
  }
  const fs::path file = folder / "start_pose.txt";
  run_program({context.programs->path("eval"),
               "--ground-truth",
               dataset.ground_truth.string(),
               "--pose-at-ns",
               std::to_string(stamp.time_since_epoch().count()),
               "--displaced",
               displacement},
              file,
              stop);
  std::string pose = text_of(file);
  pose.erase(std::min(pose.find('\n'), pose.size()));
  return pose;
}

/// What fleetloc-replay and fleetloc-robot have in common.
Words playing_options(const Run& run,
                      const RunContext& context,
                      const Place& place,
                      const std::stop_token& stop) {
  const fs::path config = place.folder / "configuration.yaml";
  write_text(config, run.configuration->yaml);
  Words words{"--dataset",
              context.inputs->dataset(run.dataset->name).path.string(),
              "--config",
              config.string(),
              "--out",
              place.folder.string()};
  if (run.dataset->plays_tracks()) words.emplace_back("--tracks");
  if (run.start_s > 0.0) {
    words.insert(words.end(), {"--start", exact_text(run.start_s)});
  }
  if (context.plan->duration_s) {
    words.insert(words.end(), {"--duration", exact_text(*context.plan->duration_s)});
  }
  if (run.configuration->odometry_only) return words;
  const fs::path link = place.folder / "link.yaml";
  write_text(link, link_yaml(link_of(run)));
  words.insert(words.end(), {"--link", link.string()});
  if (run.is_told) {
    words.insert(words.end(), {"--initial-pose", start_pose(run, context, place.folder, stop)});
  }
  return words;
}

void replay(const Run& run,
            const RunContext& context,
            const Place& place,
            const std::stop_token& stop) {
  Words words = playing_options(run, context, place, stop);
  words.insert(words.begin(), context.programs->path("replay"));
  if (!run.configuration->odometry_only) {
    words.insert(words.end(), {"--map", context.inputs->map(run.dataset->map).path.string()});
  }
  if (!run.configuration->localizers.empty()) {
    const fs::path localizers = place.folder / "localizers.yaml";
    write_text(localizers, run.configuration->localizers);
    words.insert(words.end(), {"--localizers", localizers.string()});
  }
  if (!run.dataset->faults.empty()) {
    const fs::path faults = place.folder / "faults.yaml";
    write_text(faults, run.dataset->faults);
    words.insert(words.end(), {"--faults", faults.string()});
  }
  if (run.configuration->align_once) words.emplace_back("--align-once");
  if (run.configuration->icp_baseline) words.insert(words.end(), {"--baseline", "icp"});
  run_program(words, place.folder / "log.txt", stop);
}

/// Returns once the localizer has loaded its map and joined the network.
void wait_until_serving(ChildProcess& cloud, const fs::path& log, const std::stop_token& stop) {
  constexpr std::chrono::milliseconds kLook(50);
  while (text_of(log).find("serving") == std::string::npos) {
    if (stop.stop_requested()) throw Interrupted();
    if (const auto ended = cloud.wait_for(kLook)) {
      expect_success("fleetloc-cloud", ended->exit_code == 0 ? -1 : ended->exit_code, log);
    }
  }
}

void play_over_dds(const Run& run,
                   const RunContext& context,
                   const Place& place,
                   const std::stop_token& stop) {
  const DdsOptions& dds = *context.plan->dds;
  const Words network{"--qos",
                      qos_of(*run.configuration, dds).string(),
                      "--domain",
                      std::to_string(dds.first_domain + place.slot)};
  const fs::path log = place.folder / "cloud_log.txt";
  Words robot = playing_options(run, context, place, stop);
  robot.insert(robot.begin(), {context.programs->path("robot"), "--robot-id", "robot"});
  robot.insert(robot.end(), {"--rate", exact_text(dds.rate)});
  robot.insert(robot.end(), network.begin(), network.end());
  std::optional<ChildProcess> cloud;
  if (!run.configuration->odometry_only) {
    Words words{context.programs->path("cloud"),
                "--name",
                "localizer",
                "--map",
                context.inputs->map(run.dataset->map).path.string(),
                "--config",
                (place.folder / "configuration.yaml").string(),
                "--out",
                (place.folder / "localizer").string()};
    words.insert(words.end(), network.begin(), network.end());
    cloud.emplace(ChildCommand{.arguments = words, .output = log, .errors = log});
    wait_until_serving(*cloud, log, stop);
  }
  try {
    run_program(robot, place.folder / "log.txt", stop);
  } catch (...) {
    if (cloud) cloud->end(kGrace);
    throw;
  }
  if (!cloud) return;
  expect_success("fleetloc-cloud", cloud->end(kGrace).exit_code, log);
  fs::copy_file(place.folder / "localizer" / "sessions.json", place.folder / "sessions.json");
}

}  // namespace

void play(const Run& run,
          const RunContext& context,
          const Place& place,
          const std::stop_token& stop) {
  if (context.plan->mode == Mode::kDds) {
    play_over_dds(run, context, place, stop);
  } else {
    replay(run, context, place, stop);
  }
}

}  // namespace fleetloc
