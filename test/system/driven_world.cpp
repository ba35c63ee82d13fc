#include "test/system/driven_world.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "test/system/kept_folder.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

const fs::path kWorlds = FLEETLOC_SOURCE_DIR "/deploy/worlds";
const fs::path kKept = FLEETLOC_BINARY_DIR "/driven_world";
constexpr double kRound = 100.0;  // at least so long takes one around the block [s]

const std::vector<fs::path> kMakers{
    FLEETLOC_SIM, FLEETLOC_MAP, kWorlds / "campus.yaml", kWorlds / "quad.yaml"};

/// @param carried  of `sim`, with a comma before it
void simulate(const fs::path& out,
              const fs::path& route,
              const Words& more,
              const std::string& carried = "") {
  const fs::path config = out.parent_path() / "sim.yaml";
  std::ofstream(config) << "sim: {images: {rate_hz: 10}" << carried << "}\n";
  Words words{"--scene",
              kWorlds / "campus.yaml",
              "--route",
              route,
              "--built-along",
              kWorlds / "quad.yaml",
              "--config",
              config,
              "--out",
              out};
  words.insert(words.end(), more.begin(), more.end());
  must_run(FLEETLOC_SIM, words);
}

void make_map(const fs::path& folder) {
  simulate(folder / "survey", kWorlds / "quad.yaml", {"--no-images", "--lidar"});
  must_run(FLEETLOC_MAP,
           {"build",
            "--cloud",
            folder / "survey" / "mav0" / "pointcloud0" / "data.ply",
            "--out",
            folder / "map.pcd"});
  fs::remove_all(folder / "survey");
}

/// quad.yaml with so many rounds, as it is or from its end.
fs::path route(const fs::path& folder, int rounds, bool reverse) {
  const std::string once = "laps: 1";
  std::string text = content_of(kWorlds / "quad.yaml");
  text.replace(text.find(once), once.size(), "laps: " + std::to_string(rounds));
  fs::path file = folder / (reverse ? "reverse.yaml" : "forward.yaml");
  std::ofstream(file) << text << "reverse: " << (reverse ? "true" : "false") << '\n';
  return file;
}

RecordedFlight drive(const fs::path& folder) {
  return {.folder = folder,
          .ground_truth = folder / "mav0" / "state_groundtruth_estimate0" / "data.csv"};
}

}  // namespace

DrivenWorld DrivenWorld::kept(double min_s) {
  const int rounds = std::max(1, static_cast<int>(std::ceil(min_s / kRound)));
  const fs::path drives = kKept / ("rounds_" + std::to_string(rounds));
  keep(kKept / "campus", kMakers, make_map);
  keep(drives, kMakers, [rounds](const fs::path& folder) {
    simulate(folder / "forward", route(folder, rounds, false), {"--seed", "2", "--tracks"});
    simulate(folder / "reverse", route(folder, rounds, true), {"--seed", "3", "--tracks"});
  });
  return {.map = kKept / "campus" / "map.pcd",
          .forward = drive(drives / "forward"),
          .reverse = drive(drives / "reverse")};
}

RecordedFlight DrivenWorld::carried(int at_s, int to_s) {
  const std::string part = std::to_string(at_s) + "_" + std::to_string(to_s);
  const std::string carried =
      ", carried: {at_s: " + std::to_string(at_s) + ", for_s: " + std::to_string(to_s - at_s) + "}";
  const fs::path folder = kKept / ("carried_" + part);
  keep(folder, kMakers, [&carried](const fs::path& made) {
    simulate(made / "drive",
             route(made, 2, false),
             {"--seed", "4", "--tracks", "--duration", "100"},
             carried);
  });
  return drive(folder / "drive");
}

}  // namespace fleetloc
