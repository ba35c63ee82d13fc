#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/core/time.hpp"
#include "test/fleet/docker_fleet.hpp"
#include "test/system/recorded_flight.hpp"

namespace fleetloc {

struct DrivingRobot {
  std::string id;
  std::string site;  ///< of the DockerFleet
  RecordedFlight flight;
  double start_s = 0.0;  ///< into the flight
};

/// The project's programs in a DockerFleet: localizers with a map, and robots that play recorded
/// tracks in real time. Each writes to a folder of its own.
class DrivingFleet {
 public:
  /// @param folder   gets a folder for each robot and localizer
  /// @param drive_s  length of each robot's drive
  DrivingFleet(const std::filesystem::path& folder, std::filesystem::path map, double drive_s);

  [[nodiscard]] const DockerFleet& containers() const { return containers_; }
  [[nodiscard]] std::filesystem::path folder_of(const std::string& name) const {
    return folder_ / name;
  }

  void start_discovery() { containers_.start_discovery(); }
  /// @param options  of `docker create`
  void start_localizer(const std::string& name, const DockerFleet::Words& options = {});
  void start_localizer(const std::string& name,
                       const std::filesystem::path& map,
                       const DockerFleet::Words& options);
  /// Waits until it has its map and sends its status. Throws std::runtime_error if that takes a
  /// minute.
  void wait_until_it_serves(const std::string& localizer) const;
  /// Restarts one that has been killed.
  void start_again(const std::string& localizer) const;
  /// @param run  name of its container and folder
  void start_robot(const DrivingRobot& robot, const std::string& run);

  /// The localizer that most of these robots had their last answer from. Throws
  /// std::runtime_error if none had any.
  [[nodiscard]] std::string busiest(const std::vector<DrivingRobot>& robots) const;
  /// Stamp of the last frame of a run so far.
  [[nodiscard]] Timestamp reached(const std::string& run) const;

 private:
  std::filesystem::path folder_;
  std::filesystem::path map_;
  double drive_s_;
  DockerFleet containers_;
};

/// Seconds of data from `since` to the next applied answer; infinite if there is none.
double until_answer(const std::filesystem::path& run, Timestamp since);
/// The same to the next frame whose state is `localized`.
double until_localized(const std::filesystem::path& run, Timestamp since);
/// Longest time between two applied answers, of which the later one came after `since` [s].
double longest_silence(const std::filesystem::path& run, Timestamp since);

/// What is wrong with the tables (`.csv`, `.tum`: whole lines of equally many fields) and JSON
/// files of a folder, a line each; empty: nothing.
std::string damage_of(const std::filesystem::path& folder);

}  // namespace fleetloc
