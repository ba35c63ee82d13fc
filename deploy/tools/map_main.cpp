// fleetloc-map: makes laser maps and shows what is in them.
#include <filesystem>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "cloud/laser_map/build_map.hpp"
#include "cloud/laser_map/map_file.hpp"
#include "cloud/laser_map/map_hash.hpp"
#include "shared/config/program.hpp"
#include "shared/config/progress_line.hpp"
#include "shared/pointcloud/point_cloud_file.hpp"

namespace {

using namespace fleetloc;

struct BuildOptions {
  std::string cloud;
  std::string out;
  std::string frame = "map";
};

constexpr double kPlanar = 0.8;  // sigma across is at most a fifth of that along

void print(const LaserMap& map) {
  const MapInfo& info = map.info();
  std::cout << "frame        " << info.frame << "\nresolution   " << info.resolution_m
            << " m\npoints       " << map.size() << "\nplanar       "
            << 100.0 * planar_share(map, kPlanar) << " % (planarity " << kPlanar
            << " or more)\nmin          " << info.min.transpose() << " m\nmax          "
            << info.max.transpose() << " m\ncontent hash " << to_string(info.hash) << '\n';
}

int build(const std::vector<Eigen::Vector3f>& points,
          const BuildOptions& options,
          const MapConfig& config) {
  LaserMap map = [&] {
    ProgressLine line("normals");
    return build_map(points, options.frame, config, [&line](std::size_t done, std::size_t total) {
      line.show(done, total);
    });
  }();
  const std::filesystem::path out = options.out;
  if (out.has_parent_path()) std::filesystem::create_directories(out.parent_path());
  save_map(map, out);
  std::cout << "points read  " << points.size() << '\n';
  print(map);
  return kSuccess;
}

Program::Run prepare_build(const BuildOptions& options, const MapConfig& config) {
  if (std::filesystem::path(options.out).extension() != ".pcd") {
    throw std::invalid_argument("--out: '" + options.out + "' does not end in .pcd");
  }
  return [points = read_points(options.cloud), options, config] {
    return build(points, options, config);
  };
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    Program program("fleetloc-map", "Makes a laser map of a point cloud, or shows what is in one.");
    BuildOptions options;
    std::string shown;
    CLI::App& app = program.options();
    app.require_subcommand(1);
    CLI::App* build_command =
        app.add_subcommand("build", "Make map.pcd and map.yaml of a point cloud")->fallthrough();
    build_command->add_option("--cloud", options.cloud, "PLY or PCD file")->required();
    build_command->add_option("--out", options.out, "map.pcd")->required();
    build_command->add_option("--frame", options.frame, "name of the points' frame (map)");
    CLI::App* info_command =
        app.add_subcommand("info", "Check a map and describe it")->fallthrough();
    info_command->add_option("map", shown, "map.pcd")->required();
    return program.run(argc, argv, [&]() -> Program::Run {
      if (build_command->parsed()) {
        return prepare_build(options, read_map_config(program.config().section("map")));
      }
      return [map = std::make_shared<const LaserMap>(load_map(shown))] {
        print(*map);
        return static_cast<int>(kSuccess);
      };
    });
  });
}
