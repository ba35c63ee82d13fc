#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/system/loopback_network.hpp"
#include "test/system/recorded_flight.hpp"
#include "test/system/simulated_flight.hpp"

namespace fleetloc {

/// fleetloc-robot and fleetloc-cloud on a network of their own, on a flight: the simulated one in a
/// room, unless a test takes another.
class DdsFixture : public testing::Test {
 protected:
  using Arguments = std::vector<std::string>;

  void SetUp() override {
    if (flight_.folder.empty()) flight_ = simulated_room();
  }

  /// The command line of a robot with a start pose at its first image.
  /// @param start_s  seconds of the flight to skip
  [[nodiscard]] Arguments robot(const std::string& id,
                                const Arguments& more,
                                const std::string& start_s = "0") const {
    Arguments arguments{"--robot-id",
                        id,
                        "--dataset",
                        flight_.folder.string(),
                        "--qos",
                        qos_,
                        "--domain",
                        network_.domain(),
                        "--start",
                        start_s,
                        "--initial-pose",
                        flight_.displaced_start_pose(std::stod(start_s)),
                        "--out",
                        folder_of(id).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  [[nodiscard]] Arguments cloud(const std::string& name) {
    if (map_.empty()) map_ = built_map(flight_, scratch_);
    return {"--name",
            name,
            "--map",
            map_.string(),
            "--qos",
            qos_,
            "--domain",
            network_.domain(),
            "--out",
            folder_of(name).string()};
  }

  [[nodiscard]] std::filesystem::path folder_of(const std::string& name) const {
    return scratch_ / name;
  }

  RecordedFlight flight_;
  const ScratchFolder scratch_;
  const LoopbackNetwork network_;
  std::string qos_ = network_.qos();

 private:
  std::filesystem::path map_;
};

}  // namespace fleetloc
