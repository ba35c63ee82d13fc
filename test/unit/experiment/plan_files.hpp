#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "deploy/evaluation/experiment/plan.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {

inline void write(const std::string& name, const std::string& text) {
  const auto file = test_folder() / name;
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

/// A recorded dataset, a map and a plan that names them.
inline void write_small_inputs() {
  write("flight/mav0/cam0/data.csv", "#timestamp [ns],filename\n1000,1000.png\n2000,2000.png\n");
  write("flight/mav0/state_groundtruth_estimate0/data.csv", "1000,0,0,0,1,0,0,0\n");
  write("room.pcd", "points");
}

inline std::string small_plan() {
  return "title: small\n"
         "mode: replay\n"
         "maps:\n"
         "  room: {file: room.pcd}\n"
         "datasets:\n"
         "  flight: {folder: flight, map: room}\n"
         "configurations:\n"
         "  default: {}\n"
         "  short: {config: {localizer: {window: 10}}}\n"
         "  alone: {odometry_only: true}\n"
         "links:\n"
         "  ideal: {}\n"
         "  poor: {loss: 0.5, bandwidth_bytes_per_s: 1000, down: {latency_s: 2}}\n"
         "seeds: [1, 2]\n";
}

inline Plan read_text(const std::string& text) {
  write("plan.yaml", text);
  return read_plan(test_folder() / "plan.yaml", [](const ConfigReader&) {});
}

/// The text with one part replaced by another.
inline std::string with(std::string text, const std::string& part, const std::string& other) {
  const std::size_t at = text.find(part);
  return at == std::string::npos ? "no such part" : text.replace(at, part.size(), other);
}

}  // namespace fleetloc
