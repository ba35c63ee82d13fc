// fleetloc-sim: makes a dataset with ground truth.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include "cloud/laser_map/build_map.hpp"
#include "cloud/point_cloud/point_cloud_file.hpp"
#include "deploy/config/default_config.hpp"
#include "deploy/sim/recording/sim_landmarks.hpp"
#include "deploy/sim/recording/sim_run.hpp"
#include "deploy/sim/recording/sim_sheet.hpp"
#include "deploy/sim/recording/sim_tracks.hpp"
#include "deploy/sim/recording/surfels.hpp"
#include "deploy/sim/world/scene.hpp"
#include "robot/dataset/image_file.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/option_check.hpp"
#include "shared/config/program.hpp"

namespace {

using namespace fleetloc;

struct Arguments {
  std::string scene;
  std::string route;
  std::string built_along;
  std::string season;
  std::string cloud;
  std::string trajectory;
  std::string calibration;
  std::uint64_t scene_seed = 1;
  double rest_s = 0.0;
  double start_s = 0.0;
  std::optional<double> duration_s;
  bool no_images = false;
  bool compare_tracks = false;
  std::string contact_sheet;
  bool no_merged_cloud = false;
  SimOptions sim;
};

void add_options(CLI::App& app, Arguments& arguments) {
  auto* scene = app.add_option("--scene", arguments.scene, "YAML: a world, see deploy/worlds");
  auto* route = app.add_option("--route",
                               arguments.route,
                               "way through it: YAML with waypoints, or poses (.tum, EuRoC's .csv) "
                               "that a smoothing spline follows");
  app.add_option(
         "--built-along",
         arguments.built_along,
         "way that the world is built around (that of --route, which otherwise must stay on "
         "its streets): several robots in one world")
      ->needs(scene);
  app.add_option("--season", arguments.season, "season of the scene (that of its survey)")
      ->needs(scene);
  app.add_option("--scene-seed", arguments.scene_seed, "what is built along the route (1)")
      ->check(whole_number())
      ->needs(scene);
  app.add_option("--rest", arguments.rest_s, "seconds of standstill before recorded poses")
      ->check(number_in(0.0, kLongest_s))
      ->needs(route);
  auto* cloud = app.add_option("--cloud", arguments.cloud, "instead of a scene: PLY or PCD file")
                    ->excludes(scene);
  auto* trajectory = app.add_option("--trajectory",
                                    arguments.trajectory,
                                    "recorded poses in it (.tum, EuRoC's .csv), taken as true")
                         ->excludes(route);
  scene->needs(route);
  route->needs(scene);
  cloud->needs(trajectory);
  trajectory->needs(cloud);
  app.add_option("--imu", arguments.sim.recorded_imu, "EuRoC's data.csv, copied as it is")
      ->check(CLI::ExistingFile)
      ->needs(trajectory);
  app.add_option("--calibration", arguments.calibration, "dataset whose cameras are simulated");
  app.add_option("--out", arguments.sim.out, "dataset folder, is created");
  app.add_option("--seed", arguments.sim.seed, "of noise, vibration and errors of the sensors (1)")
      ->check(whole_number());
  app.add_option("--threads", arguments.sim.threads, "the result is the same with any number (2)")
      ->check(CLI::Range(1, 64));
  app.add_option("--start", arguments.start_s, "seconds of the motion to skip")
      ->check(number_in(0.0, kLongest_s));
  app.add_option("--duration", arguments.duration_s, "seconds of the motion to simulate")
      ->check(positive_up_to(kLongest_s));
  auto* lidar = app.add_flag("--lidar", arguments.sim.lidar, "lidar0/ and pointcloud0/data.ply");
  app.add_flag("--no-merged-cloud", arguments.no_merged_cloud, "leave pointcloud0/data.ply out")
      ->needs(lidar);
  app.add_flag("--tracks", arguments.sim.tracks, "feature tracks (tracks0/) instead of images");
  app.add_flag("--no-images", arguments.no_images, "leave the images out");
  app.add_flag("--compare-tracks",
               arguments.compare_tracks,
               "write no dataset: print what simulated tracks are like beside those that the front "
               "end makes of rendered images");
  app.add_option("--contact-sheet",
                 arguments.contact_sheet,
                 "write no dataset, but a PNG file with views of every season")
      ->needs(scene);
}

// Along the whole path, whatever part of it is simulated: seasons share the scene.
Scene built_scene(const Arguments& arguments,
                  const SimMotion& motion,
                  const SimConfig& config,
                  const SceneConfig& scene) {
  if (arguments.built_along.empty())
    return build_scene(scene, motion.path_map, arguments.scene_seed);
  const auto streets_m = path_along(arguments.built_along, config);
  try {
    expect_within(motion.path_map, streets_m, static_cast<double>(scene.clearance_m));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(arguments.route + ": " + error.what() + " (" +
                                arguments.built_along + ")");
  }
  return build_scene(scene, streets_m, arguments.scene_seed);
}

SeasonScene one_session(const Arguments& arguments,
                        const SimMotion& motion,
                        const SimConfig& config) {
  const WorldConfig world = read_world_config(ConfigReader::from_file(arguments.scene));
  const std::string& name = arguments.season.empty() ? world.survey : arguments.season;
  const SeasonConfig& season = season_named(world, name);
  const Scene scene = built_scene(arguments, motion, config, world.scene);
  return apply_season(scene, season, season_named(world, world.survey));
}

std::vector<SeasonScene> all_sessions(const Arguments& arguments,
                                      const SimMotion& motion,
                                      const SimConfig& config) {
  const WorldConfig world = read_world_config(ConfigReader::from_file(arguments.scene));
  const Scene scene = built_scene(arguments, motion, config, world.scene);
  std::vector<SeasonScene> seasons;
  for (const SeasonConfig& season : world.seasons) {
    seasons.push_back(apply_season(scene, season, season_named(world, world.survey)));
  }
  return seasons;
}

SeasonScene scene_of_cloud(const std::string& file,
                           const Program& program,
                           const SurfelConfig& surfels) {
  const MapConfig config = read_map_config(program.config().section("map"));
  return surfel_scene(build_map(read_points(file), "map", config), surfels);
}

void set_part(const Arguments& arguments, const SimMotion& motion, SimOptions& options) {
  const double duration_s = motion.motion.duration();
  if (arguments.start_s >= duration_s) {
    throw std::invalid_argument("--start: the motion takes " + std::to_string(duration_s) + " s");
  }
  options.begin_s = arguments.start_s;
  options.end_s = duration_s;
  if (arguments.duration_s) {
    options.end_s = std::min(duration_s, options.begin_s + *arguments.duration_s);
  }
}

void print(const SimCounts& counts, const SimOptions& options) {
  std::cout << "written     " << counts.frames << " stereo pairs";
  if (options.lidar) std::cout << ", " << counts.scans << " lidar scans";
  if (options.merged_cloud) {
    std::cout << ", " << counts.merged_points << " points " << counts.merged_voxel_m << " m apart";
  }
  std::cout << '\n';
}

/// What is simulated, once everything has been read.
struct Prepared {
  std::shared_ptr<const SimMotion> motion;
  std::shared_ptr<const SeasonScene> scene;
  SimConfig config;
  SimOptions options;
  std::shared_ptr<Termination> termination;
};

int write_dataset(const Prepared& prepared) {
  std::cout << description(*prepared.motion) << "scene       " << prepared.scene->triangles()
            << " triangles\n"
            << std::flush;
  const std::stop_token stop = prepared.termination->token();
  print(simulate(*prepared.motion, *prepared.scene, prepared.config, prepared.options, stop),
        prepared.options);
  if (!stop.stop_requested()) return kSuccess;
  std::cerr << "fleetloc-sim: interrupted, the dataset is not complete\n";
  return kFailedAtRunTime;
}

int print_comparison(const Prepared& prepared, const FeatureTracker::Config& front_end) {
  SimConfig config = prepared.config;
  config.renderer.threads = prepared.options.threads;
  const double rate_hz = config.frame_rate_hz;
  const SimFrames frames{
      .motion = prepared.motion.get(),
      .scene = prepared.scene.get(),
      .first = static_cast<std::uint64_t>(std::ceil(prepared.options.begin_s * rate_hz)),
      .end = static_cast<std::uint64_t>(prepared.options.end_s * rate_hz) + 1};
  const auto result = compare_tracks(
      frames, config, front_end, prepared.options.seed, prepared.termination->token());
  print(std::cout, "simulated", result.simulated, "front end", result.tracked);
  return kSuccess;
}

void print_unmapped(const Prepared& prepared,
                    const std::vector<SeasonScene>& seasons,
                    const std::string& survey,
                    const SimConfig& config) {
  const auto& map = *std::ranges::find(
      seasons, survey, [](const SeasonScene& season) { return season.config().name; });
  std::cout << "landmarks without a surface in a map made in " << survey << ":\n";
  for (const SeasonScene& season : seasons) {
    const double share =
        unmapped_share(*prepared.motion, season, map, config, prepared.options.seed);
    std::cout << "  " << season.config().name << ' ' << std::lround(100.0 * share) << " %\n";
  }
}

Program::Run prepared_sheet(const Arguments& arguments, const Prepared& prepared) {
  if (std::filesystem::path(arguments.contact_sheet).extension() != ".png") {
    throw std::invalid_argument("--contact-sheet: '" + arguments.contact_sheet +
                                "' does not end in .png");
  }
  SimConfig config = prepared.config;
  config.renderer.threads = arguments.sim.threads;
  return [config,
          prepared,
          seasons = all_sessions(arguments, *prepared.motion, config),
          survey = read_world_config(ConfigReader::from_file(arguments.scene)).survey,
          file = arguments.contact_sheet] {
    constexpr int kUnused = 100;  // quality of a JPEG
    write_image(
        file, contact_sheet(*prepared.motion, seasons, config, prepared.options.seed), kUnused);
    print_unmapped(prepared, seasons, survey, config);
    return static_cast<int>(kSuccess);
  };
}

void check_out(const Arguments& arguments) {
  if (arguments.compare_tracks || !arguments.contact_sheet.empty()) return;
  if (arguments.sim.out.empty()) throw std::invalid_argument("--out is required");
  expect_no_dataset(arguments.sim.out);
}

Program::Run prepared(const Arguments& arguments, const Program& program) {
  Prepared result;
  result.termination = std::make_shared<Termination>();  // before any thread
  check_out(arguments);
  ConfigReader reader = program.config();
  result.config = read_sim_config(reader.section("sim"));
  if (arguments.scene.empty() && arguments.cloud.empty()) {
    throw std::invalid_argument("--scene and --route, or --cloud and --trajectory are required");
  }
  if (!arguments.calibration.empty()) result.config.cameras = read_cameras(arguments.calibration);
  const bool replayed = !arguments.cloud.empty();
  result.motion = std::make_shared<const SimMotion>(
      replayed
          ? replayed_motion(arguments.trajectory, result.config)
          : driven_motion(
                {.file = arguments.route, .rest_s = arguments.rest_s, .seed = arguments.sim.seed},
                result.config));
  result.options = arguments.sim;
  result.options.images = !arguments.no_images && !arguments.sim.tracks;
  result.options.merged_cloud = arguments.sim.lidar && !arguments.no_merged_cloud;
  set_part(arguments, *result.motion, result.options);
  if (!arguments.contact_sheet.empty()) return prepared_sheet(arguments, result);
  result.scene = std::make_shared<const SeasonScene>(
      replayed ? scene_of_cloud(arguments.cloud, program, result.config.surfels)
               : one_session(arguments, *result.motion, result.config));
  if (!arguments.compare_tracks) return [result] { return write_dataset(result); };
  return [result, front_end = read_feature_tracker_config(reader.section("tracking"))] {
    return print_comparison(result, front_end);
  };
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    cv::setNumThreads(1);
    Program program("fleetloc-sim",
                    "Makes a dataset in the EuRoC layout with ground truth: a stereo camera, an "
                    "IMU and a lidar on a robot that drives through a made-up scene (--scene, "
                    "--route), or along a recorded trajectory through a point cloud (--cloud, "
                    "--trajectory).",
                    default_config("everything"));
    Arguments arguments;
    add_options(program.options(), arguments);
    return program.run(argc, argv, [&] { return prepared(arguments, program); });
  });
}
