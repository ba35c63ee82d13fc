// fleetloc-map: makes laser maps and shows what is in them.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cloud/laser_map/build_map.hpp"
#include "cloud/laser_map/map_file.hpp"
#include "cloud/laser_map/map_hash.hpp"
#include "cloud/laser_map/map_regions.hpp"
#include "cloud/locate/pyramid_config.hpp"
#include "cloud/locate/pyramid_file.hpp"
#include "cloud/mapping/merge_sessions.hpp"
#include "cloud/point_cloud/point_cloud_file.hpp"
#include "deploy/config/default_config.hpp"
#include "shared/config/program.hpp"
#include "shared/config/progress_line.hpp"

namespace {

using namespace fleetloc;

struct BuildOptions {
  std::string cloud;
  std::vector<std::string> datasets;
  std::string out;
  std::string frame = "map";
  std::vector<double> without;  // x_min, y_min, x_max, y_max [m]
};

constexpr double kPlanar = 0.8;      // sigma across is at most a fifth of that along
constexpr double kMinPlanar = 0.05;  // share of the points; maps of real places have half or more

void print(const LaserMap& map) {
  const MapInfo& info = map.info();
  std::cout << "frame        " << info.frame << "\nresolution   " << info.resolution_m
            << " m\npoints       " << map.size() << "\nplanar       "
            << 100.0 * planar_share(map, kPlanar) << " % (planarity " << kPlanar
            << " or more)\nmin          " << info.min.transpose() << " m\nmax          "
            << info.max.transpose() << " m\ncontent hash " << to_string(info.hash) << '\n';
}

// A map that is too sparse for its normals is a map in which nobody is localized for long.
void warn_if_sparse(const LaserMap& map, const MapConfig& config) {
  if (planar_share(map, kPlanar) >= kMinPlanar) return;
  std::cerr
      << "fleetloc-map: warning: hardly any point lies on a surface that its neighbours show, "
         "so robots will not be localized: the points are too far apart for "
         "map.normal_radius_m "
      << config.normal_radius_m << ". Three times their distance is enough (--config)\n";
}

LaserMap map_of(std::vector<Eigen::Vector3f> points,
                const BuildOptions& options,
                const MapConfig& config) {
  if (const auto& area = options.without; !area.empty()) {
    points =
        points_outside(std::move(points), {.min = {area[0], area[1]}, .max = {area[2], area[3]}});
  }
  ProgressLine line("normals");
  LaserMap map =
      build_map(points, options.frame, config, [&line](std::size_t done, std::size_t total) {
        line.show(done, total);
      });
  warn_if_sparse(map, config);
  return map;
}

constexpr double kMegabyte = 1e6;

/// map.pyramid beside map.pcd: localizers search in it for robots that do not know where they are.
void store_pyramid(const LaserMap& map,
                   const std::filesystem::path& map_file,
                   const PyramidConfig& config) {
  const MapPyramid::Config cells = pyramid_cells(map.info(), config);
  const MapPyramid pyramid(map, cells);
  const auto file = pyramid_file(map_file);
  save_pyramid(pyramid, cells, map.info().hash, file);
  const auto megabytes = [](std::size_t bytes) { return static_cast<double>(bytes) / kMegabyte; };
  std::cout << "pyramid      cells of " << cells.cell_m << " m, "
            << megabytes(std::filesystem::file_size(file)) << " MB stored, "
            << megabytes(pyramid.bytes()) << " MB in memory, the points of the map "
            << megabytes(map.size() * sizeof(MapPoint)) << " MB\n";
}

void save(const LaserMap& map, const std::filesystem::path& out) {
  if (out.has_parent_path()) std::filesystem::create_directories(out.parent_path());
  save_map(map, out);
}

/// map_report.yaml beside map.pcd.
void write_report(const MergeReport& report, const std::filesystem::path& map_file) {
  const auto file = map_file.parent_path() / (map_file.stem().string() + "_report.yaml");
  std::ofstream stream(file);
  stream << "# Of " << map_file.filename().string() << ": what became of the scans, in points.\n"
         << report_text(report);
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
}

MergedSessions merged(const std::vector<SurveySession>& sessions, const MappingConfig& config) {
  std::optional<ProgressLine> line;
  std::string shown;
  return merge_sessions(
      sessions, config, [&](const std::string& pass, std::size_t done, std::size_t total) {
        if (pass != std::exchange(shown, pass)) line.emplace(pass);
        line->show(done, total);
      });
}

struct BuildConfig {
  MapConfig map;
  MappingConfig mapping;
  PyramidConfig pyramid;
};

Program::Run prepare_build_of_cloud(const BuildOptions& options, const BuildConfig& config) {
  return [points = read_points(options.cloud), options, config] {
    const LaserMap map = map_of(points, options, config.map);
    save(map, options.out);
    std::cout << "points read  " << points.size() << '\n';
    print(map);
    store_pyramid(map, options.out, config.pyramid);
    return kSuccess;
  };
}

Program::Run prepare_build_of_datasets(const BuildOptions& options, const BuildConfig& config) {
  auto sessions = std::make_shared<std::vector<SurveySession>>();
  for (const std::string& dataset : options.datasets) {
    sessions->emplace_back(dataset, config.mapping.max_gap);
  }
  return [sessions, options, config] {
    MergedSessions merge = merged(*sessions, config.mapping);
    const MapConfig as_merged = at_resolution(config.map, merge.report.voxel_m);
    const LaserMap map = map_of(std::exchange(merge.points_map, {}), options, as_merged);
    save(map, options.out);
    write_report(merge.report, options.out);
    std::cout << report_text(merge.report);
    print(map);
    store_pyramid(map, options.out, config.pyramid);
    return kSuccess;
  };
}

Program::Run prepare_build(const BuildOptions& options, const Program& program) {
  if (options.cloud.empty() == options.datasets.empty()) {
    throw std::invalid_argument("build: either --cloud or --dataset is required");
  }
  if (std::filesystem::path(options.out).extension() != ".pcd") {
    throw std::invalid_argument("--out: '" + options.out + "' does not end in .pcd");
  }
  if (const auto& area = options.without;
      !area.empty() && !(area[0] < area[2] && area[1] < area[3])) {
    throw std::invalid_argument("--without: must be X_MIN Y_MIN X_MAX Y_MAX with room between");
  }
  const BuildConfig config{.map = read_map_config(program.config().section("map")),
                           .mapping = read_mapping_config(program.config()),
                           .pyramid = read_pyramid_config(program.config().section("pyramid"))};
  return options.cloud.empty() ? prepare_build_of_datasets(options, config)
                               : prepare_build_of_cloud(options, config);
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    Program program(
        "fleetloc-map",
        "Makes a laser map of a point cloud or of lidar scans, or shows what is in one.",
        default_config("everything"));
    BuildOptions options;
    std::string shown;
    CLI::App& app = program.options();
    app.require_subcommand(1);
    CLI::App* build_command =
        app.add_subcommand("build", "Make map.pcd and map.yaml of points")->fallthrough();
    build_command->add_option("--cloud", options.cloud, "PLY or PCD file");
    build_command->add_option("--dataset",
                              options.datasets,
                              "instead: folders with lidar scans (mav0/lidar0) and their poses, of "
                              "one or more sessions in one frame; what stays is kept");
    build_command->add_option("--out", options.out, "map.pcd")->required();
    build_command->add_option("--frame", options.frame, "name of the points' frame (map)");
    build_command
        ->add_option(
            "--without", options.without, "X_MIN Y_MIN X_MAX Y_MAX [m]: leave out what lies there")
        ->expected(4);
    CLI::App* info_command =
        app.add_subcommand("info", "Check a map and describe it")->fallthrough();
    info_command->add_option("map", shown, "map.pcd")->required();
    CLI::App* pyramid_command =
        app.add_subcommand("pyramid",
                           "Store map.pyramid beside a map that has none, or with other values of "
                           "the configuration: localizers then start sooner")
            ->fallthrough();
    pyramid_command->add_option("map", shown, "map.pcd")->required();
    return program.run(argc, argv, [&]() -> Program::Run {
      if (build_command->parsed()) {
        return prepare_build(options, program);
      }
      const auto map = std::make_shared<const LaserMap>(load_map(shown));
      if (pyramid_command->parsed()) {
        return [map, shown, config = read_pyramid_config(program.config().section("pyramid"))] {
          store_pyramid(*map, shown, config);
          return static_cast<int>(kSuccess);
        };
      }
      return [map, regions = load_map_regions(shown)] {
        print(*map);
        for (const auto& [name, region] : regions) std::cout << "region       " << name << '\n';
        return static_cast<int>(kSuccess);
      };
    });
  });
}
