#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <variant>
#include <vector>

namespace fleetloc {

/// A line of mav0/imu0/data.csv.
struct RecordedImu {
  std::int64_t stamp_ns = 0;
  std::array<double, 6> values{};  ///< angular velocity [rad/s], specific force [m/s^2]
};

/// Of mav0/cam0 and cam1, not read yet.
struct RecordedPair {
  std::int64_t stamp_ns = 0;
  std::filesystem::path left;
  std::filesystem::path right;
};

using RecordedSample = std::variant<RecordedImu, RecordedPair>;

std::int64_t stamp_ns(const RecordedSample& sample);

/// A folder in the EuRoC/ASL layout from its first IMU sample on, in the order of the stamps; an
/// IMU sample comes before the pair of its stamp. Pairs that are not complete are left out. Throws
/// std::runtime_error.
/// @param duration_s  of the images
std::vector<RecordedSample> recorded_sensors(const std::filesystem::path& folder,
                                             double duration_s);

}  // namespace fleetloc
