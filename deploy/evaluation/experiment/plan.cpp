#include "deploy/evaluation/experiment/plan.hpp"

#include <algorithm>
#include <cmath>

#include "deploy/evaluation/experiment/plan_sections.hpp"
#include "shared/core/ids.hpp"

namespace fleetloc {
namespace {

/// The entries of a mapping whose keys are names of the user's, in their order.
template <typename Spec, typename Read>
std::vector<Spec> read_axis(ConfigReader& plan, const std::string& key, const Read& read) {
  ConfigReader section = plan.section(key);
  std::vector<Spec> specs;
  for (const std::string& name : section.keys_in_order()) {
    if (!is_valid_id(name)) section.fail(name, "a name is 1 to 32 of A-Z a-z 0-9 _ -");
    specs.push_back(read(name, section.section(name)));
  }
  if (specs.empty()) plan.fail(key, "is empty");
  return specs;
}

std::vector<std::uint64_t> read_seeds(ConfigReader& plan) {
  const auto numbers = plan.get<std::vector<std::int64_t>>("seeds");
  if (numbers.empty()) plan.fail("seeds", "is empty");
  std::vector<std::uint64_t> seeds;
  for (const std::int64_t number : numbers) {
    if (number < 0) plan.fail("seeds", "must not be negative");
    const auto seed = static_cast<std::uint64_t>(number);
    if (std::ranges::find(seeds, seed) != seeds.end()) {
      plan.fail("seeds", std::to_string(seed) + " is there twice");
    }
    seeds.push_back(seed);
  }
  return seeds;
}

Mode read_mode(ConfigReader& plan) {
  const auto mode = plan.get<std::string>("mode");
  if (mode != "replay" && mode != "dds") plan.fail("mode", "must be replay or dds");
  return mode == "dds" ? Mode::kDds : Mode::kReplay;
}

StartError read_start_error(ConfigReader section) {
  constexpr double kFarthest_m = 100.0;
  constexpr double kHalfTurn_deg = 180.0;
  return {.position_m = section.number("position_m", 0.0, kFarthest_m),
          .yaw_deg = section.number("yaw_deg", 0.0, kHalfTurn_deg)};
}

DdsOptions read_dds(ConfigReader section, const std::filesystem::path& base) {
  constexpr int kLastDomain = 100;
  DdsOptions dds{.qos = existing_file(section, "qos", base)};
  if (section.has("rate")) dds.rate = section.positive("rate");
  if (section.has("first_domain")) {
    dds.first_domain = section.integer("first_domain", 0, kLastDomain);
  }
  return dds;
}

/// Only a replay has the control that is aligned once, the baseline, localizers that come and go,
/// and faults; only DDS has profiles.
void expect_playable(const Plan& plan, ConfigReader reader) {
  ConfigReader datasets = reader.section("datasets");
  for (const DatasetSpec& spec : plan.datasets) {
    if (plan.mode == Mode::kDds && !spec.faults.empty()) {
      datasets.section(spec.group).fail("carried", "reset: only a replay can");
    }
  }
  ConfigReader configurations = reader.section("configurations");
  for (const ConfigurationSpec& spec : plan.configurations) {
    if (plan.mode == Mode::kReplay) {
      if (!spec.qos.empty()) configurations.section(spec.name).fail("qos", "only with mode: dds");
      continue;
    }
    ConfigReader section = configurations.section(spec.name);
    if (spec.align_once) section.fail("align_once", "only a replay can");
    if (spec.icp_baseline) section.fail("baseline", "only a replay can");
    if (!spec.localizers.empty()) section.fail("localizers", "only a replay can");
  }
}

void expect_known_maps(const Plan& plan, ConfigReader reader) {
  ConfigReader datasets = reader.section("datasets");
  for (const DatasetSpec& dataset : plan.datasets) {
    if (std::ranges::find(plan.maps, dataset.map, &MapSpec::name) == plan.maps.end()) {
      datasets.section(dataset.group).fail("map", "there is no map '" + dataset.map + "'");
    }
  }
}

}  // namespace

Plan read_plan(const std::filesystem::path& file, const ConfigurationCheck& check) {
  ConfigReader reader = ConfigReader::from_file(file);
  const auto base = std::filesystem::absolute(file).parent_path();
  Plan plan;
  plan.title = reader.get<std::string>("title");
  if (reader.has("description")) plan.description = reader.get<std::string>("description");
  plan.mode = read_mode(reader);
  if (plan.mode == Mode::kDds) plan.dds = read_dds(reader.section("dds"), base);
  constexpr double kLongest_s = 1e6;
  if (reader.has("start_s")) plan.start_s = reader.number("start_s", 0.0, kLongest_s);
  if (reader.has("duration_s")) plan.duration_s = reader.positive("duration_s");
  if (reader.has("start_error")) plan.start_error = read_start_error(reader.section("start_error"));
  plan.maps = read_axis<MapSpec>(reader, "maps", [&](const auto& name, const auto& section) {
    return read_map_spec(name, section, base);
  });
  const auto groups = read_axis<std::vector<DatasetSpec>>(
      reader, "datasets", [&](const auto& name, const auto& section) {
        return read_dataset_specs(name, section, base);
      });
  for (const auto& specs : groups) {
    plan.datasets.insert(plan.datasets.end(), specs.begin(), specs.end());
  }
  plan.configurations = read_axis<ConfigurationSpec>(
      reader, "configurations", [&](const auto& name, const auto& section) {
        return read_configuration_spec(name, section, base, check);
      });
  plan.links = read_axis<LinkSpec>(reader, "links", [&](const auto& name, const auto& section) {
    return read_link_spec(name, section, base);
  });
  plan.seeds = read_seeds(reader);
  reader.expect_fully_read();
  expect_known_maps(plan, reader);
  expect_playable(plan, reader);
  return plan;
}

}  // namespace fleetloc
