#include "test/fleet/docker_fleet.hpp"

#include <algorithm>
#include <array>
#include <iostream>
#include <stdexcept>

#include <unistd.h>

#include "test/system/recorded_flight.hpp"

namespace fleetloc {
namespace {

constexpr std::array<const char*, 2> kSites{"east", "west"};
constexpr int kSubnets = 240;

Outcome tried(const std::vector<std::string>& words) {
  std::vector<std::string> command{"docker"};
  command.insert(command.end(), words.begin(), words.end());
  return run("/usr/bin/env", command);
}

std::string one_line(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

std::string at_the_same_path(const std::filesystem::path& folder) {
  return std::string(folder).append(":").append(folder);
}

// An image without files: all of them come from this machine, read-only, and so nothing has to be
// fetched or installed. Links are as Debian has them.
void make_image(const std::string& name) {
  const ScratchFolder scratch;
  const auto root = scratch / "root";
  for (const char* folder : {"etc", "proc", "sys", "dev", "tmp", "run", "usr", "var"}) {
    std::filesystem::create_directories(root / folder);
  }
  for (const char* link : {"bin", "sbin", "lib", "lib64"}) {
    std::filesystem::create_symlink(std::filesystem::path("usr") / link, root / link);
  }
  const auto archive = (scratch / "root.tar").string();
  must_run("/usr/bin/tar", {"-C", root.string(), "-cf", archive, "."});
  docker({"import", archive, name});
}

// However this process ends, also killed, its containers, networks and image go. Runs in a session
// of its own.
void clean_up_after_this_process(const std::string& prefix) {
  const std::string me = std::to_string(getpid());
  std::string script = "tail --pid=" + me + " -f /dev/null; ";
  script += "docker rm --force $(docker ps --all --quiet --filter name=" + prefix + "-); ";
  for (const char* site : kSites) script += "docker network rm " + prefix + "-" + site + "; ";
  script += "docker rmi " + prefix;
  const std::string detached =
      "setsid sh -c \"$0\" >/dev/null 2>&1 & "
      "until [ \"$(cut -d ' ' -f 6 /proc/$!/stat)\" = $! ]; do :; done";  // its own session
  must_run("/bin/sh", {"-c", detached, script});
}

}  // namespace

Outcome docker(const std::vector<std::string>& words) {
  Outcome outcome = tried(words);
  if (outcome.exit_code != 0) {
    std::string command = "docker";
    for (const std::string& word : words) command += " " + word;
    throw std::runtime_error(command + ": " + one_line(outcome.errors));
  }
  return outcome;
}

std::optional<std::string> DockerFleet::why_impossible() {
  if (tried({"info"}).exit_code != 0) return "no Docker daemon answers";
  if (!std::filesystem::exists("/usr/bin/fast-discovery-server")) {
    return "there is no /usr/bin/fast-discovery-server";
  }
  return std::nullopt;
}

DockerFleet::DockerFleet(std::filesystem::path outputs)
    : outputs_(std::move(outputs)),
      prefix_("fleetloc-test-" + std::to_string(getpid())),
      first_subnet_(2 * static_cast<int>(getpid() % (kSubnets / 2))) {
  clean_up_after_this_process(prefix_);
  try {
    make_image(prefix_);
    for (const char* site : kSites) create_network(site);
  } catch (...) {
    remove_everything();
    throw;
  }
}

// Another fleet may be on the addresses: there are as many as an octet has, twice the process's
// number to begin with.
void DockerFleet::create_network(const std::string& site) {
  for (int tries = 0;; ++tries) {
    subnets_[site] = "10.213." + std::to_string((first_subnet_ + tries) % kSubnets);
    try {
      docker({"network", "create", "--internal", "--subnet", subnet(site) + ".0/24", full(site)});
      return;
    } catch (const std::runtime_error& error) {
      const bool is_taken = std::string(error.what()).find("overlaps") != std::string::npos;
      if (!is_taken || tries == kSubnets) throw;
    }
  }
}

DockerFleet::~DockerFleet() {
  remove_everything();
}

void DockerFleet::remove_everything() const noexcept {
  try {
    for (const std::string& name : containers_) tried({"rm", "--force", full(name)});
    for (const char* site : kSites) tried({"network", "rm", full(site)});
    tried({"rmi", prefix_});
  } catch (const std::exception& error) {
    std::cerr << "not removed: " << error.what() << '\n';
  }
}

std::string DockerFleet::subnet(const std::string& site) const {
  return subnets_.at(site);
}

void DockerFleet::create(const std::string& name,
                         const std::string& network,
                         const Words& command,
                         const Words& options) {
  Words words{"create",
              "--name",
              full(name),
              "--network",
              full(network),
              "--network-alias",
              name,
              "--cap-drop",
              "ALL",
              "--security-opt",
              "no-new-privileges:true"};
  for (const char* folder : {"/usr",
                             "/etc/alternatives",
                             "/etc/ld.so.cache",
                             FLEETLOC_SOURCE_DIR,
                             FLEETLOC_BINARY_DIR}) {
    words.insert(words.end(), {"--volume", at_the_same_path(folder) + ":ro"});
  }
  words.insert(words.end(), {"--volume", at_the_same_path(outputs_)});
  words.insert(words.end(), options.begin(), options.end());
  words.push_back(prefix_);
  words.insert(words.end(), command.begin(), command.end());
  containers_.push_back(name);
  docker(words);
}

void DockerFleet::start_in_cloud(const std::string& name,
                                 const Words& command,
                                 const Words& options) {
  create(name, kSites[0], command, options);
  docker({"network", "connect", "--alias", name, full(kSites[1]), full(name)});
  start_again(name);
}

void DockerFleet::start_at(const std::string& site, const std::string& name, const Words& command) {
  create(name, site, command, {});
  start_again(name);
}

void DockerFleet::start_discovery() {
  start_in_cloud("discovery",
                 {"/usr/bin/fast-discovery-server", "-i", "0", "-l", "0.0.0.0", "-p", "11811"});
}

void DockerFleet::kill(const std::string& name) const {
  docker({"kill", "--signal", "KILL", full(name)});
  wait(name);
}

void DockerFleet::start_again(const std::string& name) const {
  docker({"start", full(name)});
}

// On a busy machine the kernel does not always freeze it within the few milliseconds that Docker's
// runtime waits ("unable to freeze"); it goes on then.
void DockerFleet::pause(const std::string& name) const {
  constexpr int kTries = 5;
  for (int i = 1; i < kTries; ++i) {
    if (tried({"pause", full(name)}).exit_code == 0) return;
  }
  docker({"pause", full(name)});
}

void DockerFleet::unpause(const std::string& name) const {
  docker({"unpause", full(name)});
}

void DockerFleet::pull_out(const std::string& site, const std::string& name) const {
  docker({"network", "disconnect", full(site), full(name)});
}

void DockerFleet::plug_in(const std::string& site, const std::string& name, int address) const {
  docker({"network",
          "connect",
          "--ip",
          subnet(site) + "." + std::to_string(address),
          "--alias",
          name,
          full(site),
          full(name)});
}

int DockerFleet::stop(const std::string& name) const {
  docker({"stop", "--time", "20", full(name)});
  return wait(name);
}

int DockerFleet::wait(const std::string& name) const {
  return std::stoi(docker({"wait", full(name)}).output);
}

std::string DockerFleet::logs(const std::string& name) const {
  const Outcome outcome = docker({"logs", full(name)});
  return outcome.output + outcome.errors;
}

std::string DockerFleet::inspect(const std::string& name, const std::string& format) const {
  return one_line(docker({"inspect", "--format", format, full(name)}).output);
}

}  // namespace fleetloc
