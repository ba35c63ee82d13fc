#include "test/system/driven_world.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

const fs::path kWorlds = FLEETLOC_SOURCE_DIR "/deploy/worlds";
const fs::path kKept = FLEETLOC_BINARY_DIR "/driven_world";
constexpr double kRound = 100.0;  // at least so long takes one around the block [s]

/// One process at a time has it.
class FileLock {
 public:
  explicit FileLock(const fs::path& file)
      : descriptor_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0 || flock(descriptor_, LOCK_EX) != 0) {
      throw std::runtime_error(file.string() + ": cannot be locked");
    }
  }
  ~FileLock() { close(descriptor_); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int descriptor_;
};

bool is_older_than_its_makers(const fs::path& made) {
  if (!fs::exists(made)) return true;
  const std::vector<fs::path> makers{
      FLEETLOC_SIM, FLEETLOC_MAP, kWorlds / "campus.yaml", kWorlds / "quad.yaml"};
  return std::ranges::any_of(makers, [&made](const fs::path& maker) {
    return fs::last_write_time(maker) > fs::last_write_time(made);
  });
}

void simulate(const fs::path& out, const fs::path& route, const Words& more) {
  const fs::path config = out.parent_path() / "ten_hertz.yaml";
  std::ofstream(config) << "sim: {images: {rate_hz: 10}}\n";
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

/// Makes `folder` by `make`, unless it is there and newer than its makers.
template <typename Make>
void keep(const fs::path& folder, const Make& make) {
  if (!is_older_than_its_makers(folder / "made")) return;
  fs::remove_all(folder);
  fs::create_directories(folder);
  make(folder);
  std::ofstream(folder / "made") << "by " << FLEETLOC_SIM << '\n';
}

RecordedFlight drive(const fs::path& folder) {
  return {.folder = folder,
          .ground_truth = folder / "mav0" / "state_groundtruth_estimate0" / "data.csv"};
}

}  // namespace

DrivenWorld DrivenWorld::kept(double min_s) {
  const int rounds = std::max(1, static_cast<int>(std::ceil(min_s / kRound)));
  const fs::path drives = kKept / ("rounds_" + std::to_string(rounds));
  fs::create_directories(kKept);
  const FileLock lock(kKept / "lock");
  keep(kKept / "campus", make_map);
  keep(drives, [rounds](const fs::path& folder) {
    simulate(folder / "forward", route(folder, rounds, false), {"--seed", "2", "--tracks"});
    simulate(folder / "reverse", route(folder, rounds, true), {"--seed", "3", "--tracks"});
  });
  return {.map = kKept / "campus" / "map.pcd",
          .forward = drive(drives / "forward"),
          .reverse = drive(drives / "reverse")};
}

}  // namespace fleetloc
