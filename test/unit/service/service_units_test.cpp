#include <cstdio>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

namespace fleetloc {
namespace {

const std::string kDeploy = FLEETLOC_SOURCE_DIR "/deploy/";

/// Settings of a unit of systemd or of its environment; of several of one name the last.
std::map<std::string, std::string> settings_of(const std::string& unit) {
  std::ifstream file(kDeploy + "packages/" + unit);
  std::map<std::string, std::string> settings;
  for (std::string line; std::getline(file, line);) {
    for (std::string next; line.ends_with('\\') && std::getline(file, next);) {
      line.pop_back();
      line += next;
    }
    const auto equals = line.find('=');
    if (line.starts_with('#') || equals == std::string::npos) continue;
    settings[line.substr(0, equals)] = line.substr(equals + 1);
  }
  return settings;
}

double draining_s() {
  return YAML::LoadFile(kDeploy + "config/cloud.yaml")["pool"]["draining"]["max_s"].as<double>();
}

/// Where a value of the compose file is left to the environment (`${NAME:-value}`): that value.
std::string by_default(const std::string& value) {
  return std::regex_replace(value, std::regex(R"(\$\{\w+:-([^}]*)\})"), "$1");
}

/// Value of a key of a service of the compose file, or of what it takes over by `<<`.
YAML::Node setting_of(const YAML::Node& service, const std::string& key) {
  if (const YAML::Node value = service[key]) return value;
  if (const YAML::Node base = service["<<"]) return setting_of(base, key);
  return YAML::Node(YAML::NodeType::Undefined);
}

TEST(ServiceUnits, AreWatchedRestartedIfTheyFailAndNotIfTheyCannotStart) {
  for (const char* unit : {"fleetloc-cloud.service", "fleetloc-robot.service"}) {
    SCOPED_TRACE(unit);
    auto settings = settings_of(unit);
    EXPECT_EQ(settings["Type"], "notify");
    EXPECT_EQ(settings["WatchdogSec"], "20");
    EXPECT_EQ(settings["Restart"], "on-failure");
    EXPECT_EQ(settings["RestartPreventExitStatus"], "2");
    EXPECT_EQ(settings["DynamicUser"], "yes");
    EXPECT_EQ(settings["ProtectSystem"], "strict");
    EXPECT_EQ(settings["SystemCallErrorNumber"], "EPERM") << "the default kills";
  }
}

TEST(ServiceUnits, HaveCopiesOfKeysThatOnlyRootCanRead) {
  for (const std::string part : {"cloud", "robot"}) {
    SCOPED_TRACE(part);
    const std::string keys = "/etc/fleetloc/" + part + "-keys";
    auto settings = settings_of("fleetloc-" + part + ".service");
    const std::string start = "/usr/share/fleetloc/" + part + "/start ";
    EXPECT_EQ(settings["ExecStartPre"], "+" + start + "copy-keys " + keys) << "by root";
    EXPECT_EQ(settings["RuntimeDirectory"], "fleetloc-" + part);
    EXPECT_EQ(settings["RuntimeDirectoryMode"], "0700");
    EXPECT_TRUE(settings["ExecStart"].starts_with(start + part + " " + keys + " "))
        << settings["ExecStart"];
    EXPECT_EQ(settings["ExecStart"].find("--qos"), std::string::npos);
    EXPECT_EQ(settings_of(part + ".env")["FLEETLOC_SECURITY"], "on");
  }
}

TEST(ServiceUnits, LeaveALocalizerTheTimeToDrain) {
  EXPECT_GT(std::stod(settings_of("fleetloc-cloud.service").at("TimeoutStopSec")), draining_s());
  const YAML::Node compose = YAML::LoadFile(kDeploy + "docker/compose.yml");
  for (const char* name : {"localizer_1", "localizer_2"}) {
    const auto grace = setting_of(compose["services"][name], "stop_grace_period").as<std::string>();
    EXPECT_GT(std::stod(grace), draining_s()) << name;
    EXPECT_TRUE(grace.ends_with('s')) << grace;
  }
}

TEST(ComposeFile, GivesNoContainerRightsOrANetworkBeyondTheFleets) {
  const YAML::Node compose = YAML::LoadFile(kDeploy + "docker/compose.yml");
  EXPECT_EQ(compose["networks"].size(), 5U);
  for (const auto& network : compose["networks"]) {
    EXPECT_TRUE(network.second["internal"].as<bool>(false)) << network.first;
  }
  EXPECT_GE(compose["services"].size(), 8U);
  for (const auto& service : compose["services"]) {
    SCOPED_TRACE(service.first.as<std::string>());
    EXPECT_TRUE(setting_of(service.second, "read_only").as<bool>(false));
    ASSERT_TRUE(setting_of(service.second, "cap_drop"));
    EXPECT_EQ(setting_of(service.second, "cap_drop")[0].as<std::string>(), "ALL");
    EXPECT_FALSE(setting_of(service.second, "ports"));
    EXPECT_FALSE(setting_of(service.second, "privileged"));
  }
}

/// Members of a fleet that a compose file has, each with its own keys.
std::set<std::string> members_with_keys(const YAML::Node& compose) {
  std::set<std::string> members;
  for (const auto& entry : compose["services"]) {
    const auto name = entry.first.as<std::string>();
    SCOPED_TRACE(name);
    std::vector<std::string> mounts;
    for (const auto& volume : setting_of(entry.second, "volumes")) {
      const auto text = volume.as<std::string>();
      if (text.find("FLEETLOC_KEYS") != std::string::npos) mounts.push_back(text);
    }
    const bool is_localizer = name.starts_with("localizer_");
    if (!is_localizer && !name.starts_with("robot_")) {
      EXPECT_TRUE(mounts.empty());
      continue;
    }
    const YAML::Node environment = setting_of(entry.second, "environment");
    const auto variable = [&](const char* key) {
      return by_default(setting_of(environment, key).as<std::string>());
    };
    EXPECT_EQ(variable("FLEETLOC_SECURITY"), "on");
    EXPECT_TRUE(variable("FLEETLOC_QOS").ends_with("/nbiot-secure-peers.xml"))
        << variable("FLEETLOC_QOS");
    const std::string member = is_localizer ? "localizers/" + variable("FLEETLOC_NAME")
                                            : "robots/" + variable("FLEETLOC_ROBOT_ID");
    EXPECT_EQ(mounts.size(), 1U);
    if (mounts.size() != 1) continue;
    EXPECT_TRUE(mounts[0].ends_with("}/" + member + ":/keys:ro")) << mounts[0];
    EXPECT_TRUE(members.insert(member).second) << "a second " << member;
  }
  return members;
}

TEST(ComposeFile, GivesWhoeverSpeaksDdsASecureProfileAndItsOwnKeysOnly) {
  EXPECT_EQ(members_with_keys(YAML::LoadFile(kDeploy + "docker/compose.yml")).size(), 4U);
}

TEST(ComposeFile, IsRepeatedForFurtherRobotsEachWithItsOwnKeysAndDrivers) {
  const std::string docker = kDeploy + "docker/";
  const std::string command =
      "awk -v east=12 -v west=2 -f " + docker + "robots.awk " + docker + "compose.yml";
  std::string text;
  FILE* const output = popen(command.c_str(), "r");
  ASSERT_NE(output, nullptr);
  for (int c = std::fgetc(output); c != EOF; c = std::fgetc(output)) {
    text.push_back(static_cast<char>(c));
  }
  ASSERT_EQ(pclose(output), 0);
  const YAML::Node compose = YAML::Load(text);
  const std::set<std::string> members = members_with_keys(compose);
  EXPECT_EQ(members.size(), 16U);
  for (const char* id : {"robots/east_1", "robots/east_12", "robots/west_1", "robots/west_2"}) {
    EXPECT_TRUE(members.contains(id)) << id;
  }
  for (const char* name : {"east_1", "east_12", "west_2"}) {
    const YAML::Node drivers = compose["services"][std::string("drivers_") + name];
    ASSERT_TRUE(drivers) << name;
    EXPECT_EQ(drivers["environment"]["FLEETLOC_ROBOT"].as<std::string>(),
              std::string("robot_") + name);
  }
}

}  // namespace
}  // namespace fleetloc
