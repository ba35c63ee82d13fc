#include "deploy/evaluation/experiment/inputs.hpp"

#include "deploy/evaluation/experiment/fingerprint.hpp"
#include "shared/core/exact_text.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

std::string dataset_identity(const SimulatedDataset& dataset, const Programs& programs) {
  Fingerprint fingerprint;
  if (!dataset.built_along.empty()) fingerprint.add_file("streets", dataset.built_along);
  return fingerprint.add("program", programs.fingerprint("sim"))
      .add_file("scene", dataset.scene)
      .add_file("route", dataset.route)
      .add("season", dataset.season)
      .add("seed", std::to_string(dataset.seed))
      .add("scene seed", std::to_string(dataset.scene_seed))
      .add("rest", exact_text(dataset.rest_s))
      .add("start", exact_text(dataset.start_s))
      .add("duration", dataset.duration_s ? exact_text(*dataset.duration_s) : "all")
      .add("tracks", dataset.tracks ? "yes" : "no")
      .add("survey", dataset.survey ? "yes" : "no")
      .add("config", dataset.config)
      .text();
}

std::vector<std::string> simulation(const SimulatedDataset& dataset,
                                    const Programs& programs,
                                    const fs::path& folder,
                                    int threads) {
  std::vector<std::string> words{programs.path("sim"),
                                 "--scene",
                                 dataset.scene.string(),
                                 "--route",
                                 dataset.route.string(),
                                 "--season",
                                 dataset.season,
                                 "--seed",
                                 std::to_string(dataset.seed),
                                 "--scene-seed",
                                 std::to_string(dataset.scene_seed),
                                 "--threads",
                                 std::to_string(threads),
                                 "--out",
                                 folder.string()};
  const auto add = [&words](const std::string& option, double value) {
    words.insert(words.end(), {option, exact_text(value)});
  };
  if (!dataset.built_along.empty()) {
    words.insert(words.end(), {"--built-along", dataset.built_along.string()});
  }
  if (dataset.rest_s > 0.0) add("--rest", dataset.rest_s);
  if (dataset.start_s > 0.0) add("--start", dataset.start_s);
  if (dataset.duration_s) add("--duration", *dataset.duration_s);
  if (dataset.tracks) words.emplace_back("--tracks");
  if (dataset.survey) words.insert(words.end(), {"--lidar", "--no-images", "--no-merged-cloud"});
  if (!dataset.config.empty()) {
    const fs::path file = folder / "sim_config.yaml";
    write_text(file, dataset.config);
    words.insert(words.end(), {"--config", file.string()});
  }
  return words;
}

}  // namespace

Inputs::Inputs(const Plan& plan, const Programs& programs, fs::path store)
    : programs_(&programs), store_(std::move(store)) {
  for (const MapSpec& map : plan.maps) maps_[map.name] = input_of(map);
  for (const DatasetSpec& dataset : plan.datasets) datasets_[dataset.name] = input_of(dataset);
}

Input Inputs::simulated(const SimulatedDataset& dataset) {
  const std::string identity = dataset_identity(dataset, *programs_);
  const fs::path folder = store_ / "datasets" / identity;
  recipes_.emplace(folder, dataset);
  return {.path = folder,
          .identity = identity,
          .ground_truth = folder / "mav0" / "state_groundtruth_estimate0" / "data.csv"};
}

Input Inputs::input_of(const DatasetSpec& spec) {
  if (const auto* dataset = std::get_if<SimulatedDataset>(&spec.source)) return simulated(*dataset);
  const auto& dataset = std::get<RecordedDataset>(spec.source);
  return {.path = dataset.folder,
          .identity = Fingerprint()
                          .add_folder("dataset", dataset.folder)
                          .add_file("ground truth", dataset.ground_truth)
                          .text(),
          .ground_truth = dataset.ground_truth};
}

Input Inputs::input_of(const MapSpec& spec) {
  if (!spec.file.empty()) {
    return {.path = spec.file,
            .identity = Fingerprint().add_file("map", spec.file).text(),
            .ground_truth = {}};
  }
  Fingerprint fingerprint;
  fingerprint.add("program", programs_->fingerprint("map"));
  std::vector<std::string> words{programs_->path("map"), "build"};
  if (!spec.cloud.empty()) {
    fingerprint.add_file("cloud", spec.cloud);
    words.insert(words.end(), {"--cloud", spec.cloud.string()});
  } else {
    words.emplace_back("--dataset");
    for (const SimulatedDataset& survey : spec.surveys) {
      const Input input = simulated(survey);
      fingerprint.add("survey", input.identity);
      words.push_back(input.path.string());
    }
  }
  if (spec.without) {
    words.emplace_back("--without");
    for (const double edge : *spec.without) words.push_back(exact_text(edge));
    for (const double edge : *spec.without) fingerprint.add("edge", exact_text(edge));
  }
  const std::string identity = fingerprint.text();
  const fs::path folder = store_ / "maps" / identity;
  map_recipes_[folder] = words;
  return {.path = folder / "map.pcd", .identity = identity, .ground_truth = {}};
}

std::vector<Task> Inputs::missing_datasets(int threads) const {
  std::vector<Task> tasks;
  for (const auto& [folder, dataset] : recipes_) {
    if (fs::exists(folder)) continue;
    const std::string name = (dataset.survey ? "survey " : "dataset ") + dataset.season;
    tasks.push_back(
        {name,
         [this, name, threads, folder = folder, dataset = dataset](const std::stop_token& stop,
                                                                   int) {
           make_folder(folder, [&](const fs::path& part) {
             run_program(simulation(dataset, *programs_, part, threads), part / "log.txt", stop);
           });
           return name + ": " + folder.string();
         }});
  }
  return tasks;
}

std::vector<Task> Inputs::missing_maps() const {
  std::vector<Task> tasks;
  for (const auto& [folder, words] : map_recipes_) {
    if (fs::exists(folder)) continue;
    tasks.push_back({"map", [folder = folder, words = words](const std::stop_token& stop, int) {
                       make_folder(folder, [&](const fs::path& part) {
                         std::vector<std::string> command = words;
                         command.insert(command.end(), {"--out", (part / "map.pcd").string()});
                         run_program(command, part / "log.txt", stop);
                       });
                       return "map: " + folder.string();
                     }});
  }
  return tasks;
}

void make_folder(const fs::path& folder, const std::function<void(const fs::path& part)>& make) {
  const fs::path part = folder.string() + ".part";
  fs::remove_all(part);  // of a process that was killed
  fs::create_directories(part);
  try {
    make(part);
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(part, ignored);
    throw;
  }
  fs::rename(part, folder);
}

}  // namespace fleetloc
