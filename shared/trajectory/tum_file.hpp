#pragma once

#include <filesystem>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "shared/trajectory/trajectory.hpp"

namespace fleetloc {

/// A trajectory file that cannot be read. The message names file and line.
class TrajectoryFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Seconds with nine decimals, exact.
std::string stamp_text(Timestamp stamp);

/// Writes `stamp_s tx ty tz qx qy qz qw` with 9 decimals and a line end; the stamp is exact.
void write_tum_line(std::ostream& stream, Timestamp stamp, const Pose& T_ref_body);

/// Reads what write_tum_line() writes, and files of EuRoC's ground truth (.csv: stamp in ns,
/// position, quaternion w x y z; what follows is ignored). Quaternions are normalized. Throws
/// TrajectoryFileError, also if stamps do not increase; a file without poses is an empty
/// trajectory.
Trajectory read_trajectory(const std::filesystem::path& path);

/// The same for records whose stamps jitter: they may repeat and go back; poses are in the order of
/// the file.
std::vector<StampedPose> read_poses_in_any_order(const std::filesystem::path& path);

}  // namespace fleetloc
