#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "test/system/child_program.hpp"

namespace fleetloc {

/// Runs `docker` with these words. Throws std::runtime_error with what it said unless it succeeds.
Outcome docker(const std::vector<std::string>& words);

/// Containers on networks of their own, with a discovery server: the built programs with this
/// machine's libraries, without capabilities, and without access to other networks. Sites `east`
/// and `west` reach the cloud's side only. Everything is removed with this object, and at the
/// latest with this process.
class DockerFleet {
 public:
  /// Why Docker cannot be used here; nothing if it can.
  static std::optional<std::string> why_impossible();

  /// @param outputs  folder that containers may write to, at the same path
  explicit DockerFleet(std::filesystem::path outputs);
  ~DockerFleet();
  DockerFleet(const DockerFleet&) = delete;
  DockerFleet& operator=(const DockerFleet&) = delete;

  using Words = std::vector<std::string>;

  /// Starts a container `name` with `command`, on all networks: localizers and the server.
  /// @param options  of `docker create`
  void start_in_cloud(const std::string& name, const Words& command, const Words& options = {});
  /// Starts one at a site.
  void start_at(const std::string& site, const std::string& name, const Words& command);
  void start_discovery();

  void kill(const std::string& name) const;  ///< with SIGKILL
  void start_again(const std::string& name) const;
  void pause(const std::string& name) const;
  void unpause(const std::string& name) const;
  void pull_out(const std::string& site, const std::string& name) const;
  /// @param address  the last part of it, in the site's network
  void plug_in(const std::string& site, const std::string& name, int address) const;

  /// SIGTERM, then SIGKILL after 20 s; the exit code.
  int stop(const std::string& name) const;
  /// Waits for its end; the exit code.
  int wait(const std::string& name) const;
  [[nodiscard]] std::string logs(const std::string& name) const;
  /// What `docker inspect` says in `format`.
  [[nodiscard]] std::string inspect(const std::string& name, const std::string& format) const;

 private:
  [[nodiscard]] std::string full(const std::string& name) const { return prefix_ + "-" + name; }
  void create_network(const std::string& site);
  [[nodiscard]] std::string subnet(const std::string& site) const;
  void create(const std::string& name,
              const std::string& network,
              const Words& command,
              const Words& options);
  void remove_everything() const noexcept;

  std::filesystem::path outputs_;
  std::string prefix_;
  int first_subnet_ = 0;
  std::map<std::string, std::string> subnets_;  // by site
  std::vector<std::string> containers_;
};

}  // namespace fleetloc
