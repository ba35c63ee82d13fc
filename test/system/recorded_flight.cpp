#include "test/system/recorded_flight.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "shared/geometry/pose_text.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

const Eigen::Vector3d kDisplacement{0.2, 0.2, 0.1};      // 0.3 m long
constexpr double kYaw = 3.0 * std::numbers::pi / 180.0;  // [rad]

std::string displaced(const RecordedFlight& flight,
                      double start_s,
                      const Eigen::Vector3d& by_m,
                      double yaw_rad) {
  constexpr std::chrono::milliseconds kMaxGap{100};
  const auto T_map_body = interpolate(
      read_trajectory(flight.ground_truth), first_frame(flight.folder, start_s), kMaxGap);
  if (!T_map_body) throw std::runtime_error("no ground truth at the first frame");
  const Eigen::Quaterniond yaw = exp_so3({0.0, 0.0, yaw_rad});
  return pose_text({.R = yaw * T_map_body->R, .p = T_map_body->p + by_m});
}

}  // namespace

Outcome must_run(const std::string& program, const std::vector<std::string>& arguments) {
  Outcome outcome = run(program, arguments);
  if (outcome.exit_code != 0) throw std::runtime_error(outcome.errors);
  return outcome;
}

std::filesystem::path recordings() {
  if (const char* elsewhere = std::getenv("RECORDINGS")) return elsewhere;
  return std::filesystem::path(FLEETLOC_SOURCE_DIR).parent_path() / "shared" / "data";
}

Timestamp first_frame(const std::filesystem::path& dataset, double start_s) {
  auto file = dataset / "mav0" / "tracks0" / "data.csv";
  if (!std::filesystem::exists(file)) file = dataset / "mav0" / "cam0" / "data.csv";
  std::ifstream stream(file);
  const auto skipped = from_seconds(start_s);
  std::optional<Timestamp> first;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line.front() == '#') continue;
    const Timestamp stamp{Duration(std::stoll(line))};
    if (!first) first = stamp;
    if (stamp >= *first + skipped) return stamp;
  }
  throw std::runtime_error(file.string() + ": no frames");
}

std::string RecordedFlight::displaced_start_pose(double start_s) const {
  return displaced(*this, start_s, kDisplacement, kYaw);
}

std::string RecordedFlight::start_pose_to_the_right() const {
  return displaced(*this, 0.0, {kDisplacement.x(), -kDisplacement.y(), kDisplacement.z()}, -kYaw);
}

RecordedFlight machine_hall() {
  const auto folder = recordings() / "euroc_mh01_17s";
  return {.folder = folder,
          .ground_truth = folder / "mav0" / "state_groundtruth_estimate0" / "data.tum"};
}

RecordedFlight vicon_room() {
  const auto folder = recordings() / "semireal_v101";
  return {.folder = folder,
          .ground_truth = folder / "mav0" / "state_groundtruth_estimate0" / "data.csv"};
}

std::optional<std::string> why_missing(const RecordedFlight& flight) {
  if (std::filesystem::is_directory(flight.folder)) return std::nullopt;
  return "there is no recording " + flight.folder.string();
}

std::filesystem::path built_map(const RecordedFlight& flight, const ScratchFolder& scratch) {
  if (!flight.map.empty()) return flight.map;
  auto map = scratch / "map.pcd";
  must_run(FLEETLOC_MAP,
           {"build",
            "--cloud",
            flight.folder / "mav0" / "pointcloud0" / "data.ply",
            "--out",
            map.string()});
  return map;
}

nlohmann::json parsed_json(const std::filesystem::path& file) {
  return nlohmann::json::parse(content_of(file));
}

nlohmann::json odometry_errors(const std::filesystem::path& run, const RecordedFlight& flight) {
  const Outcome outcome = must_run(FLEETLOC_EVAL,
                                   {"--ground-truth",
                                    flight.ground_truth.string(),
                                    "--estimate",
                                    run / "odometry.tum",
                                    "--align",
                                    "se3",
                                    "--json"});
  return nlohmann::json::parse(outcome.output);
}

nlohmann::json run_errors(const std::filesystem::path& run, const RecordedFlight& flight) {
  must_run(FLEETLOC_EVAL,
           {"--ground-truth", flight.ground_truth.string(), "--run", run.string(), "--json"});
  return parsed_json(run / "evaluation.json");
}

double share_of_frames(const std::filesystem::path& run, const std::string& file) {
  const auto poses = std::ranges::count(content_of(run / file), '\n');
  const auto frames = parsed_json(run / "summary.json").at("frames").get<double>();
  return static_cast<double>(poses) / frames;
}

}  // namespace fleetloc
