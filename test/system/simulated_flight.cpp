#include "test/system/simulated_flight.hpp"

#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "test/system/kept_folder.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

const fs::path kFlightWorlds = FLEETLOC_SOURCE_DIR "/deploy/worlds";
const fs::path kKeptFlights = FLEETLOC_BINARY_DIR "/simulated_flights";
const fs::path kRecipe = FLEETLOC_SOURCE_DIR "/test/system/simulated_flight.cpp";  // this file

// Sanitized programs only get a few seconds: their figures are judged nowhere.
constexpr const char* kRoomDuration = kSanitized ? "12" : "44";   // [s]
constexpr const char* kStreetDuration = kSanitized ? "2" : "24";  // [s]
constexpr const char* kParkedRest = kSanitized ? "1" : "40";      // [s]
constexpr const char* kParkedPeople = "40.0";                     // per 100 m
constexpr const char* kParkedDuration = kSanitized ? "2" : "52";  // [s]

void simulate_flight(const fs::path& out, const char* duration_s, Words words) {
  const fs::path config = out.parent_path() / "ten_hertz.yaml";
  std::ofstream(config) << "sim: {images: {rate_hz: 10}}\n";
  words.insert(words.end(),
               {"--config", config.string(), "--duration", duration_s, "--out", out.string()});
  must_run(FLEETLOC_SIM, words);
}

void make_room(const fs::path& folder) {
  std::cout << "making " << folder << ": " << kRoomDuration << " s in a room" << std::endl;
  const auto cloud = (folder / "room.ply").string();
  const auto poses = (folder / "poses.tum").string();
  must_run(FLEETLOC_ROOM_FILES, {cloud, poses});
  must_run(FLEETLOC_MAP, {"build", "--cloud", cloud, "--out", folder / "map.pcd"});
  simulate_flight(folder / "flight", kRoomDuration, {"--cloud", cloud, "--trajectory", poses});
}

void make_street(const fs::path& folder) {
  std::cout << "making " << folder << ": " << kStreetDuration << " s on a street" << std::endl;
  const Words way{"--scene", kFlightWorlds / "campus.yaml", "--route", kFlightWorlds / "quad.yaml"};
  const fs::path survey = folder / "survey";
  Words scanned = way;
  scanned.insert(scanned.end(), {"--season", "summer", "--no-images", "--lidar"});
  simulate_flight(survey, kStreetDuration, scanned);
  must_run(FLEETLOC_MAP,
           {"build",
            "--cloud",
            survey / "mav0" / "pointcloud0" / "data.ply",
            "--out",
            folder / "map.pcd"});
  fs::remove_all(survey);
  Words seen = way;
  seen.insert(seen.end(), {"--season", "autumn", "--seed", "2"});
  simulate_flight(folder / "flight", kStreetDuration, seen);
}

// The first of such lines gets another value.
std::string with_value(std::string text, const std::string& line, const std::string& value) {
  const auto at = text.find(line);
  if (at == std::string::npos) throw std::logic_error("the world has no line '" + line + "'");
  return text.replace(at, line.size(), line.substr(0, line.find(':')) + ": " + value);
}

// The drive along the street, once the robot has stood at its begin while people passed.
void make_parked(const fs::path& folder) {
  std::cout << "making " << folder << ": " << kParkedDuration << " s on a street" << std::endl;
  const fs::path route = folder / "route.yaml";
  const fs::path scene = folder / "scene.yaml";
  std::ofstream(route) << with_value(
      content_of(kFlightWorlds / "quad.yaml"), "rest_s: 2.5", kParkedRest);
  std::ofstream(scene) << with_value(content_of(kFlightWorlds / "campus.yaml"),
                                     "people_per_100_m: 2.0",
                                     kParkedPeople);  // of autumn
  simulate_flight(folder / "flight",
                  kParkedDuration,
                  {"--scene", scene, "--route", route, "--season", "autumn"});
}

RecordedFlight kept_flight(const fs::path& kept) {
  const fs::path flight = kept / "flight";
  return {.folder = flight,
          .ground_truth = flight / "mav0" / "state_groundtruth_estimate0" / "data.csv",
          .map = kept / "map.pcd"};
}

}  // namespace

RecordedFlight simulated_room() {
  const fs::path folder = kKeptFlights / "room";
  keep(folder, {FLEETLOC_SIM, FLEETLOC_MAP, FLEETLOC_ROOM_FILES, kRecipe}, make_room);
  return kept_flight(folder);
}

RecordedFlight simulated_street() {
  const fs::path folder = kKeptFlights / "street";
  keep(folder,
       {FLEETLOC_SIM,
        FLEETLOC_MAP,
        kFlightWorlds / "campus.yaml",
        kFlightWorlds / "quad.yaml",
        kRecipe},
       make_street);
  return kept_flight(folder);
}

RecordedFlight simulated_parked() {
  RecordedFlight street = simulated_street();
  const fs::path folder = kKeptFlights / "parked";
  keep(folder,
       {FLEETLOC_SIM, kFlightWorlds / "campus.yaml", kFlightWorlds / "quad.yaml", kRecipe},
       make_parked);
  RecordedFlight parked = kept_flight(folder);
  parked.map = street.map;
  return parked;
}

}  // namespace fleetloc
