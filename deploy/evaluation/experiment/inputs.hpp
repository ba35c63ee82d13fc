#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "deploy/evaluation/experiment/plan.hpp"
#include "deploy/evaluation/experiment/programs.hpp"
#include "deploy/evaluation/experiment/schedule.hpp"

namespace fleetloc {

/// A dataset or a map, with the hash of its content or of how it is made.
struct Input {
  std::filesystem::path path;  ///< dataset folder, or map.pcd
  std::string identity;
  std::filesystem::path ground_truth;  ///< of a dataset
};

/// The datasets and maps of a plan. What has to be made is made once, in folders of `store` that
/// are named by the hash of its inputs.
class Inputs {
 public:
  /// Makes nothing yet, but reads existing files. Throws std::runtime_error.
  Inputs(const Plan& plan, const Programs& programs, std::filesystem::path store);

  /// Tasks that make what is missing: first all datasets, then all maps, which are made of
  /// datasets.
  [[nodiscard]] std::vector<Task> missing_datasets(int threads) const;
  [[nodiscard]] std::vector<Task> missing_maps() const;

  [[nodiscard]] const Input& dataset(const std::string& name) const { return datasets_.at(name); }
  [[nodiscard]] const Input& map(const std::string& name) const { return maps_.at(name); }

 private:
  Input simulated(const SimulatedDataset& dataset);
  Input input_of(const DatasetSpec& spec);
  Input input_of(const MapSpec& spec);

  const Programs* programs_;
  std::filesystem::path store_;
  std::map<std::filesystem::path, SimulatedDataset> recipes_;  ///< by folder
  /// Commands by the folder of the map, without --out.
  std::map<std::filesystem::path, std::vector<std::string>> map_recipes_;
  std::map<std::string, Input> datasets_;
  std::map<std::string, Input> maps_;
};

/// Makes the folder under a temporary name, which is removed if `make` throws.
void make_folder(const std::filesystem::path& folder,
                 const std::function<void(const std::filesystem::path& part)>& make);

}  // namespace fleetloc
