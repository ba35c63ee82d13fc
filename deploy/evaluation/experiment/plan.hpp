#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "shared/config/config_reader.hpp"
#include "shared/link/link_config.hpp"

namespace fleetloc {

/// A dataset that fleetloc-sim makes.
struct SimulatedDataset {
  std::filesystem::path scene;
  std::filesystem::path route;
  std::filesystem::path built_along;  ///< route along which the world is built; empty: this one
  std::string season;
  std::uint64_t seed = 1;
  std::uint64_t scene_seed = 1;
  double rest_s = 0.0;  ///< before recorded poses
  double start_s = 0.0;
  std::optional<double> duration_s;
  bool tracks = true;   ///< feature tracks, else images
  std::string config;   ///< YAML, what differs from the defaults
  bool survey = false;  ///< a lidar, no cameras
};

/// An existing dataset.
struct RecordedDataset {
  std::filesystem::path folder;
  std::filesystem::path ground_truth;
  bool tracks = false;
};

/// Starts along a dataset of which nobody tells the robot where they are.
struct StartsSpec {
  int count = 0;
  std::uint64_t seed = 1;  ///< of their times; the first ones of more are the same
  double from_s = 0.0;     ///< of the dataset, between which they are drawn
  double to_s = 0.0;
};

struct DatasetSpec {
  std::string name;
  std::string group;  ///< tables sum up the datasets of a group; most are alone in theirs
  std::variant<RecordedDataset, SimulatedDataset> source;
  std::string map;
  std::optional<StartsSpec> starts;  ///< else one start, which the robot is told
  std::string faults;                ///< YAML, see read_fault_plan(); empty: none

  [[nodiscard]] bool plays_tracks() const {
    return std::visit([](const auto& its) { return its.tracks; }, source);
  }
};

/// An existing map (.pcd with its .yaml), a point cloud to make one of, or surveys.
struct MapSpec {
  std::string name;
  std::filesystem::path file;
  std::filesystem::path cloud;
  std::vector<SimulatedDataset> surveys;
  std::optional<std::array<double, 4>> without;  ///< x_min, y_min, x_max, y_max, left out [m]
};

struct ConfigurationSpec {
  std::string name;
  std::string yaml;  ///< all values
  bool align_once = false;
  bool odometry_only = false;
  bool icp_baseline = false;  ///< in place of link and cloud
  std::string localizers;     ///< YAML, see read_localizer_plan(); empty: one, to the end
  std::filesystem::path qos;  ///< over DDS, in place of the plan's; empty: that one
};

struct LinkSpec {
  std::string name;
  LinkConfig link;  ///< its seed is that of a run
};

enum class Mode { kReplay, kDds };

/// Error of the start pose that a robot is given; its direction is drawn by the run's seed.
struct StartError {
  double position_m = 0.3;
  double yaw_deg = 3.0;
};

/// Of runs over DDS.
struct DdsOptions {
  std::filesystem::path qos;
  double rate = 1.0;
  int first_domain = 1;  ///< runs at the same time have domains of their own, from here on
};

/// A matrix of runs: every dataset, or every start of it, with every configuration, link and seed.
struct Plan {
  std::string title;
  std::string description;
  Mode mode = Mode::kReplay;
  std::optional<DdsOptions> dds;
  double start_s = 0.0;  ///< of the datasets to skip
  std::optional<double> duration_s;
  StartError start_error;
  std::vector<DatasetSpec> datasets;
  std::vector<MapSpec> maps;
  std::vector<ConfigurationSpec> configurations;
  std::vector<LinkSpec> links;
  std::vector<std::uint64_t> seeds;
};

/// Of a run with this configuration over DDS.
inline const std::filesystem::path& qos_of(const ConfigurationSpec& spec, const DdsOptions& dds) {
  return spec.qos.empty() ? dds.qos : spec.qos;
}

/// Throws what is wrong with the values of a configuration, which is complete.
using ConfigurationCheck = std::function<void(const ConfigReader&)>;

/// Reads a plan strictly. Files are relative to the plan's folder. Throws ConfigError, one line
/// that names file, line and key, for whatever would keep a run from starting.
Plan read_plan(const std::filesystem::path& file, const ConfigurationCheck& check);

}  // namespace fleetloc
