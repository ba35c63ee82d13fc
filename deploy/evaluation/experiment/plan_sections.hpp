#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "deploy/evaluation/experiment/plan.hpp"

namespace fleetloc {

// The entries of a plan. All throw ConfigError; files are relative to `base`.

/// One dataset, or several that differ in when and how far the robot is carried.
std::vector<DatasetSpec> read_dataset_specs(const std::string& name,
                                            ConfigReader section,
                                            const std::filesystem::path& base);
MapSpec read_map_spec(const std::string& name,
                      ConfigReader section,
                      const std::filesystem::path& base);
ConfigurationSpec read_configuration_spec(const std::string& name,
                                          ConfigReader section,
                                          const std::filesystem::path& base,
                                          const ConfigurationCheck& check);

/// Values hold in both directions, those of `up` and `down` in one; `file` is a link that they
/// change.
LinkSpec read_link_spec(const std::string& name,
                        ConfigReader section,
                        const std::filesystem::path& base);

/// The file that a key names, absolute.
std::filesystem::path existing_file(ConfigReader& section,
                                    const std::string& key,
                                    const std::filesystem::path& base);

}  // namespace fleetloc
