#include "deploy/evaluation/experiment/plan_sections.hpp"

#include <algorithm>
#include <limits>

#include "deploy/config/default_config.hpp"
#include "deploy/evaluation/experiment/draw_trials.hpp"
#include "deploy/replay/localizer_plan.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

fs::path absolute_path(const fs::path& path, const fs::path& base) {
  return (path.is_absolute() ? path : base / path).lexically_normal();
}

fs::path existing_folder(ConfigReader& section, const std::string& key, const fs::path& base) {
  fs::path folder = absolute_path(section.get<std::string>(key), base);
  if (!fs::is_directory(folder)) section.fail(key, folder.string() + ": no such folder");
  return folder;
}

std::uint64_t seed_or(ConfigReader& section, const std::string& key, std::uint64_t otherwise) {
  if (!section.has(key)) return otherwise;
  return static_cast<std::uint64_t>(section.integer(key, 0, std::numeric_limits<int>::max()));
}

void expect_season(ConfigReader& section, const fs::path& scene, const std::string& season) {
  ConfigReader world = ConfigReader::from_file(scene);
  if (!world.section("seasons").has(season)) {
    section.fail("season", "'" + season + "' is not in " + scene.string());
  }
}

SimulatedDataset read_simulated(ConfigReader section, const fs::path& base) {
  SimulatedDataset dataset;
  dataset.scene = existing_file(section, "scene", base);
  dataset.route = existing_file(section, "route", base);
  if (section.has("built_along")) {
    dataset.built_along = existing_file(section, "built_along", base);
  }
  dataset.season = section.get<std::string>("season");
  expect_season(section, dataset.scene, dataset.season);
  dataset.seed = seed_or(section, "seed", 1);
  dataset.scene_seed = seed_or(section, "scene_seed", 1);
  constexpr double kLongest_s = 1e6;
  if (section.has("rest_s")) dataset.rest_s = section.number("rest_s", 0.0, kLongest_s);
  if (section.has("start_s")) dataset.start_s = section.number("start_s", 0.0, kLongest_s);
  if (section.has("duration_s")) dataset.duration_s = section.positive("duration_s");
  if (section.has("tracks")) dataset.tracks = section.get<bool>("tracks");
  if (section.has("config")) {
    const ConfigReader config = section.section("config");
    auto defaults = ConfigReader::from_string(default_config("everything"), "defaults");
    defaults.overlay(config);
    dataset.config = config.text();
  }
  return dataset;
}

fs::path ground_truth_of(ConfigReader& section, const fs::path& folder) {
  const fs::path mav0 = fs::is_directory(folder / "mav0") ? folder / "mav0" : folder;
  for (const char* name : {"data.csv", "data.tum"}) {
    fs::path file = mav0 / "state_groundtruth_estimate0" / name;
    if (fs::is_regular_file(file)) return file;
  }
  section.fail("folder", folder.string() + ": has no ground truth; name it as ground_truth");
}

RecordedDataset read_recorded(ConfigReader& section, const fs::path& base) {
  RecordedDataset dataset;
  dataset.folder = existing_folder(section, "folder", base);
  dataset.ground_truth = section.has("ground_truth") ? existing_file(section, "ground_truth", base)
                                                     : ground_truth_of(section, dataset.folder);
  if (section.has("tracks")) dataset.tracks = section.get<bool>("tracks");
  const fs::path mav0 =
      fs::is_directory(dataset.folder / "mav0") ? dataset.folder / "mav0" : dataset.folder;
  const fs::path index = mav0 / (dataset.tracks ? "tracks0" : "cam0") / "data.csv";
  if (!fs::is_regular_file(index)) section.fail("folder", index.string() + ": no such file");
  return dataset;
}

/// Exactly one of two keys.
void expect_either(ConfigReader& section, const std::string& name, const char* a, const char* b) {
  if (section.has(a) && section.has(b)) {
    section.fail(b, std::string("stands beside ") + a + ", one of them is enough");
  }
  if (!section.has(a) && !section.has(b)) {
    section.fail(a, std::string("missing: ") + name + " needs it, or " + b);
  }
}

void read_direction(ConfigReader& section, const fs::path& base, LinkDirection& direction) {
  constexpr double kLongest_s = 3600.0;
  constexpr double kFastest = 1e12;
  if (section.has("loss")) direction.loss = section.number("loss", 0.0, 1.0);
  if (section.has("latency_s")) direction.delay_s = section.number("latency_s", 0.0, kLongest_s);
  read_impairments(section, base, direction);
  if (section.has("bandwidth_bytes_per_s")) {
    direction.rate_bytes_per_s = section.number("bandwidth_bytes_per_s", 1.0, kFastest);
  }
  const bool is_limited = section.has("bandwidth_bytes_per_s") || section.has("rate_trace") ||
                          section.has("rate_trace_file");
  if (is_limited) direction.queue_bytes = default_queue_bytes(direction);
}

}  // namespace

fs::path existing_file(ConfigReader& section, const std::string& key, const fs::path& base) {
  fs::path file = absolute_path(section.get<std::string>(key), base);
  if (!fs::is_regular_file(file)) section.fail(key, file.string() + ": no such file");
  return file;
}

std::vector<DatasetSpec> read_dataset_specs(const std::string& name,
                                            ConfigReader section,
                                            const fs::path& base) {
  expect_either(section, name, "folder", "simulated");
  DatasetSpec spec;
  spec.name = name;
  spec.group = name;
  spec.map = section.get<std::string>("map");
  if (section.has("simulated")) {
    spec.source = read_simulated(section.section("simulated"), base);
  } else {
    spec.source = read_recorded(section, base);
  }
  if (section.has("starts")) spec.starts = read_starts(section.section("starts"));
  if (!section.has("carried")) return {spec};
  if (!section.has("simulated")) section.fail("carried", "needs a simulated dataset");
  return carried_datasets(spec, read_carried(section.section("carried")));
}

MapSpec read_map_spec(const std::string& name, ConfigReader section, const fs::path& base) {
  MapSpec spec;
  spec.name = name;
  if (section.has("file")) {
    spec.file = existing_file(section, "file", base);
    return spec;
  }
  expect_either(section, name, "cloud", "surveys");
  if (section.has("without")) {
    const auto area = section.get<std::vector<double>>("without");
    if (area.size() != 4 || !(area[0] < area[2]) || !(area[1] < area[3])) {
      section.fail("without", "must be [x_min, y_min, x_max, y_max] in m");
    }
    spec.without = {area[0], area[1], area[2], area[3]};
  }
  if (section.has("cloud")) {
    spec.cloud = existing_file(section, "cloud", base);
    return spec;
  }
  ConfigReader surveys = section.section("surveys");
  for (const std::string& survey : surveys.keys_in_order()) {
    spec.surveys.push_back(read_simulated(surveys.section(survey), base));
    spec.surveys.back().survey = true;
    spec.surveys.back().tracks = false;
  }
  if (spec.surveys.empty()) section.fail("surveys", "is empty");
  return spec;
}

ConfigurationSpec read_configuration_spec(const std::string& name,
                                          ConfigReader section,
                                          const fs::path& base,
                                          const ConfigurationCheck& check) {
  ConfigurationSpec spec;
  spec.name = name;
  auto config = ConfigReader::from_string(default_config("everything"), "defaults");
  if (section.has("file")) {
    config.overlay(ConfigReader::from_file(existing_file(section, "file", base)));
  }
  if (section.has("config")) config.overlay(section.section("config"));
  spec.yaml = config.text();
  check(config);
  if (section.has("qos")) spec.qos = existing_file(section, "qos", base);
  if (section.has("align_once")) spec.align_once = section.get<bool>("align_once");
  if (section.has("odometry_only")) spec.odometry_only = section.get<bool>("odometry_only");
  if (spec.align_once && spec.odometry_only) {
    section.fail("align_once", "odometry alone is never aligned");
  }
  if (section.has("baseline")) {
    if (section.get<std::string>("baseline") != "icp") section.fail("baseline", "must be icp");
    if (spec.odometry_only) section.fail("baseline", "odometry alone is never aligned");
    spec.icp_baseline = true;
  }
  if (section.has("localizers")) {
    if (spec.odometry_only) section.fail("localizers", "odometry alone has none");
    if (spec.icp_baseline) section.fail("localizers", "the baseline has none");
    const ConfigReader localizers = section.section("localizers");
    read_localizer_plan(localizers);
    spec.localizers = localizers.text();
  }
  return spec;
}

LinkSpec read_link_spec(const std::string& name, ConfigReader section, const fs::path& base) {
  LinkSpec spec{.name = name, .link = perfect_link()};
  if (section.has("file")) spec.link = read_link_file(existing_file(section, "file", base));
  read_direction(section, base, spec.link.uplink);
  read_direction(section, base, spec.link.downlink);
  if (section.has("up")) {
    ConfigReader up = section.section("up");
    read_direction(up, base, spec.link.uplink);
  }
  if (section.has("down")) {
    ConfigReader down = section.section("down");
    read_direction(down, base, spec.link.downlink);
  }
  return spec;
}

}  // namespace fleetloc
