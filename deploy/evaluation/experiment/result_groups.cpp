#include "deploy/evaluation/experiment/result_groups.hpp"

#include <algorithm>
#include <numeric>

namespace fleetloc {

using nlohmann::json;

std::vector<Group> groups_of(const std::vector<Result>& results) {
  std::vector<Group> groups;
  for (const Result& result : results) {
    const Run& run = *result.run;
    const auto found = std::ranges::find_if(groups, [&run](const Group& group) {
      return group.run->dataset->group == run.dataset->group &&
             group.run->configuration == run.configuration && group.run->link == run.link;
    });
    Group& group =
        found == groups.end() ? groups.emplace_back(Group{.run = &run, .results = {}}) : *found;
    if (result.failure.empty()) group.results.push_back(&result);
  }
  return groups;
}

std::vector<double> values_of(const Group& group,
                              json Result::*source,
                              const std::string& pointer) {
  std::vector<double> values;
  for (const Result* result : group.results) {
    const json value = number_at(result->*source, pointer);
    if (value.is_number()) values.push_back(value.get<double>());
  }
  return values;
}

std::optional<double> mean(const std::vector<double>& values) {
  if (values.empty()) return std::nullopt;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::optional<double> mean_of(const Group& group,
                              json Result::*source,
                              const std::string& pointer) {
  return mean(values_of(group, source, pointer));
}

std::optional<double> min_of(const Group& group, json Result::*source, const std::string& pointer) {
  const auto values = values_of(group, source, pointer);
  if (values.empty()) return std::nullopt;
  return std::ranges::min(values);
}

std::optional<double> max_of(const Group& group, json Result::*source, const std::string& pointer) {
  const auto values = values_of(group, source, pointer);
  if (values.empty()) return std::nullopt;
  return std::ranges::max(values);
}

}  // namespace fleetloc
