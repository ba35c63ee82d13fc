#include "deploy/evaluation/report/configuration_table.hpp"

#include <map>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "deploy/config/default_config.hpp"
#include "deploy/evaluation/report/html.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

using Values = std::map<std::string, std::string>;  // by "section.key"

void flatten(const YAML::Node& node, const std::string& name, Values& values) {
  if (!node.IsMap()) {
    values[name] = node.IsScalar() ? node.Scalar() : YAML::Dump(node);
    return;
  }
  for (const auto& entry : node) {
    std::string key = name;
    if (!key.empty()) key += '.';
    key += entry.first.Scalar();
    flatten(entry.second, key, values);
  }
}

Values values_of(const std::string& yaml) {
  Values values;
  // The reader's own text: what is the same is spelt the same.
  flatten(YAML::Load(ConfigReader::from_string(yaml, "config.yaml").text()), "", values);
  return values;
}

}  // namespace

std::string configuration_differences(const std::string& yaml) {
  const Values defaults = values_of(std::string(default_config("everything")));
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, value] : values_of(yaml)) {
    const auto found = defaults.find(name);
    if (found != defaults.end() && found->second == value) continue;
    rows.push_back({"<code>" + escaped(name) + "</code>",
                    escaped(value),
                    found == defaults.end() ? "–" : escaped(found->second)});
  }
  return rows.empty() ? "" : table({"key", "this run", "default"}, rows);
}

}  // namespace fleetloc
