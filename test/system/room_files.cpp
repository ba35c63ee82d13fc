// room_files CLOUD.ply POSES.tum: the tests' room as a laser would scan it, and a way through it,
// for fleetloc-sim.
#include <fstream>
#include <iostream>
#include <vector>

#include "cloud/point_cloud/point_cloud_file.hpp"
#include "deploy/sim/room/room.hpp"
#include "deploy/sim/room/room_trajectory.hpp"
#include "shared/core/counter_random.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace {

using namespace fleetloc;

constexpr double kSpacing = 0.04;     // of the points [m]
constexpr double kScanSigma = 0.002;  // of each point [m]
constexpr double kRest = 2.5;         // [s]
constexpr double kSpeed = 0.8;        // root mean square [m/s]
constexpr int kPosesPerSecond = 100;
constexpr int kDuration = 45;  // [s]

std::vector<Eigen::Vector3f> scan() {
  const CounterRandom random(1, 0);
  std::vector<Eigen::Vector3f> points;
  for (const Eigen::Vector3d& p_room : Room().surface_grid(kSpacing)) {
    points.emplace_back((p_room + kScanSigma * random.normal3(points.size())).cast<float>());
  }
  return points;
}

// The trajectory's body looks along z and has x up; that of fleetloc-sim looks along x, z up.
void write_poses(std::ostream& stream) {
  Eigen::Matrix3d R;
  R << 0.0, 0.0, 1.0,  //
      0.0, -1.0, 0.0,  //
      1.0, 0.0, 0.0;
  const Eigen::Quaterniond R_euroc_body(R);
  const RoomTrajectory trajectory(kRest, kSpeed);
  for (int i = 0; i <= kDuration * kPosesPerSecond; ++i) {
    const double time_s = static_cast<double>(i) / kPosesPerSecond;
    const Pose T_room_euroc = trajectory.at(time_s).T_room_body;
    write_tum_line(stream,
                   Timestamp(std::chrono::seconds(1000)) + from_seconds(time_s),
                   {.R = T_room_euroc.R * R_euroc_body, .p = T_room_euroc.p});
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: room_files CLOUD.ply POSES.tum\n";
    return 2;
  }
  write_ply(argv[1], scan());
  std::ofstream poses(argv[2]);
  write_poses(poses);
  return poses.flush() ? 0 : 1;
}
