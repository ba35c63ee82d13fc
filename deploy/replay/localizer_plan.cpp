#include "deploy/replay/localizer_plan.hpp"

#include <utility>

#include "shared/core/ids.hpp"

namespace fleetloc {
namespace {

LocalizerPlan::Kind kind_named(const std::string& text, const std::string& origin) {
  using enum LocalizerPlan::Kind;
  if (text == "start") return kStart;
  if (text == "stop") return kStop;
  if (text == "kill") return kKill;
  throw ConfigError(origin + ": event: '" + text + "' is none of start, stop, kill");
}

LocalizerPlan::Event read_event(ConfigReader& config, const std::string& origin) {
  LocalizerPlan::Event event;
  event.at_s = config.number("at_s", 0.0, 1e6);
  event.localizer = config.get<std::string>("localizer");
  if (!is_valid_id(event.localizer)) {
    throw ConfigError(origin + ": localizer: '" + event.localizer +
                      "' is not 1 to 32 of A-Z a-z 0-9 _ -");
  }
  event.kind = kind_named(config.get<std::string>("event"), origin);
  return event;
}

}  // namespace

LocalizerPlan one_localizer(std::string_view name) {
  return {.events = {{.localizer = std::string(name), .kind = LocalizerPlan::Kind::kStart}}};
}

LocalizerPlan read_localizer_plan(ConfigReader config) {
  LocalizerPlan plan;
  const auto events = config.get<std::vector<YAML::Node>>("events");
  for (std::size_t i = 0; i < events.size(); ++i) {
    const std::string origin =
        "line " + std::to_string(events[i].Mark().line + 1) + ": event " + std::to_string(i + 1);
    try {
      ConfigReader reader = ConfigReader::from_string(YAML::Dump(events[i]), origin);
      LocalizerPlan::Event event = read_event(reader, origin);
      reader.expect_fully_read();
      if (!plan.events.empty() && event.at_s < plan.events.back().at_s) {
        throw ConfigError(origin + ": at_s: must not be before that of the event before");
      }
      plan.events.push_back(std::move(event));
    } catch (const ConfigError& error) {
      config.fail("events", error.what());
    }
  }
  config.expect_fully_read();
  return plan;
}

}  // namespace fleetloc
