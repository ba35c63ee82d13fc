#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shared/core/time.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

struct StampedCovariance {
  Timestamp stamp;
  Matrix6d covariance;  ///< right perturbation of the pose at stamp
};

/// The covariances of a run; stamps strictly increase.
struct RunCovariances {
  std::optional<Timestamp> first_frame;  ///< also before there is a pose
  std::vector<StampedCovariance> map;    ///< of T_map_body
  std::vector<StampedCovariance> odom;   ///< of T_odom_body
  std::vector<Timestamp> frames;         ///< all from the first pose in odom on
  std::vector<Timestamp> localized;      ///< those whose state is `localized`
};

/// Reads the columns `stamp_s`, `state`, `cm11..cm66` and `co11..co66` of diagnostics.csv, wherever
/// they are. A frame without a pose has `nan` or nothing there. Throws TextFileError.
RunCovariances read_covariances(const std::filesystem::path& path);

/// State and network at one frame, of diagnostics.csv.
struct FrameDiagnostics {
  Timestamp stamp;
  std::string state;
  double uplink_bytes = 0.0;           ///< payload since the start
  double downlink_bytes = 0.0;         ///< payload since the start
  double loss = 0.0;                   ///< share of datagrams, as the robot estimates it
  std::optional<double> round_trip_s;  ///< the last one measured
};

/// All frames; stamps strictly increase. Throws TextFileError.
std::vector<FrameDiagnostics> read_frame_diagnostics(const std::filesystem::path& path);

}  // namespace fleetloc
