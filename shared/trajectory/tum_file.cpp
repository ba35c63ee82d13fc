#include "shared/trajectory/tum_file.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>

#include "shared/config/delimited_file.hpp"
#include "shared/geometry/pose_text.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kTumColumns = 8;
constexpr std::size_t kEurocPoseColumns = 8;  // of 17

Eigen::Vector3d position(const DelimitedFile& file) {
  return {file.number(1), file.number(2), file.number(3)};
}

/// Columns of the four coefficients.
Eigen::Quaterniond quaternion(
    const DelimitedFile& file, std::size_t w, std::size_t x, std::size_t y, std::size_t z) {
  constexpr double kTolerance = 0.01;  // files with two decimals exist
  const Eigen::Quaterniond q(file.number(w), file.number(x), file.number(y), file.number(z));
  if (std::abs(q.norm() - 1.0) > kTolerance) file.fail("the quaternion is not of unit length");
  return q.normalized();
}

StampedPose tum_pose(const DelimitedFile& file) {
  file.expect_columns(kTumColumns);
  return {.stamp = file.seconds(0),
          .T_ref_body = {.R = quaternion(file, 7, 4, 5, 6), .p = position(file)}};
}

StampedPose euroc_pose(const DelimitedFile& file) {
  if (file.columns() < kEurocPoseColumns) file.fail("fewer than 8 columns");
  return {.stamp = file.nanoseconds(0),
          .T_ref_body = {.R = quaternion(file, 4, 5, 6, 7), .p = position(file)}};
}

/// @param check  told of each pose but the first: the file, the pose before and the stamp
template <typename Check>
std::vector<StampedPose> read(const std::filesystem::path& path, const Check& check) {
  std::vector<StampedPose> poses;
  try {
    const bool euroc = path.extension() == ".csv";
    DelimitedFile file(path, euroc ? ',' : ' ');
    while (file.next()) {
      const StampedPose pose = euroc ? euroc_pose(file) : tum_pose(file);
      if (!poses.empty()) check(file, poses.back(), pose.stamp);
      poses.push_back(pose);
    }
  } catch (const TextFileError& error) {
    throw TrajectoryFileError(error.what());
  }
  return poses;
}

}  // namespace

std::string stamp_text(Timestamp stamp) {
  constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
  const std::int64_t ns = stamp.time_since_epoch().count();
  std::array<char, 64> text{};
  std::snprintf(text.data(),
                text.size(),
                "%lld.%09lld",
                static_cast<long long>(ns / kNanosecondsPerSecond),
                static_cast<long long>(ns % kNanosecondsPerSecond));
  return text.data();
}

void write_tum_line(std::ostream& stream, Timestamp stamp, const Pose& T) {
  stream << stamp_text(stamp) << ' ' << pose_text(T) << '\n';
}

Trajectory read_trajectory(const std::filesystem::path& path) {
  return read(path, [](const DelimitedFile& file, const StampedPose& last, Timestamp stamp) {
    if (stamp <= last.stamp) file.fail("the stamp is not later than the one before");
  });
}

std::vector<StampedPose> read_poses_in_any_order(const std::filesystem::path& path) {
  return read(path, [](const DelimitedFile&, const StampedPose&, Timestamp) {});
}

}  // namespace fleetloc
