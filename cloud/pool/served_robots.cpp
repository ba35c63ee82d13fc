#include "cloud/pool/served_robots.hpp"

#include <cmath>

#include "shared/link/datagrams.hpp"

namespace fleetloc {
namespace {

constexpr double kTimeConstant_s = 5.0;

double wire_bytes(std::size_t payload_bytes) {
  double sum = 0.0;
  for (const std::size_t bytes : datagram_sizes(payload_bytes)) sum += static_cast<double>(bytes);
  return sum;
}

}  // namespace

void DecayingRate::add(double amount, Timestamp now) {
  per_second_ = per_second(now) + amount / kTimeConstant_s;
  at_ = now;
}

double DecayingRate::per_second(Timestamp now) const {
  return per_second_ * std::exp(-to_seconds(now - at_) / kTimeConstant_s);
}

void ServedRobots::open(const RobotId& robot, SessionNumber session, Timestamp now) {
  Robot& opened = robots_[robot];
  opened.known = {.localizer = localizer_, .robot = robot, .session = session};
  opened.heard = now;
}

void ServedRobots::received(const RobotId& robot, std::size_t payload_bytes, Timestamp now) {
  const auto found = robots_.find(robot);
  if (found == robots_.end()) return;
  found->second.heard = now;
  found->second.up.add(wire_bytes(payload_bytes), now);
}

void ServedRobots::sent(const RobotId& robot, std::size_t payload_bytes, Timestamp now) {
  const auto found = robots_.find(robot);
  if (found != robots_.end()) found->second.down.add(wire_bytes(payload_bytes), now);
}

void ServedRobots::told(const RobotStatus& status) {
  const auto found = robots_.find(status.robot);
  if (found == robots_.end()) return;
  found->second.known.quality = status.quality;
  found->second.known.round_trip = status.round_trip;
}

void ServedRobots::answered(const RobotId& robot, const LocalizationResult& answer) {
  const auto found = robots_.find(robot);
  if (found == robots_.end() || answer.status != LocalizationStatus::kLocalized) return;
  found->second.known.T_map_body = answer.T_map_body;
  found->second.known.covariance = answer.covariance;
}

void ServedRobots::searched(const RobotId& robot, std::vector<Eigen::Vector3d> possible_places) {
  const auto found = robots_.find(robot);
  if (found == robots_.end()) return;
  if (possible_places.size() > kMaxPossiblePlaces) possible_places.resize(kMaxPossiblePlaces);
  found->second.known.possible_places = std::move(possible_places);
}

std::vector<ServedRobot> ServedRobots::all(Timestamp now) const {
  std::vector<ServedRobot> result;
  for (const auto& [id, robot] : robots_) {
    ServedRobot served = robot.known;
    served.up_bytes_per_s = robot.up.per_second(now);
    served.down_bytes_per_s = robot.down.per_second(now);
    served.silent = now - robot.heard;
    result.push_back(std::move(served));
  }
  return result;
}

}  // namespace fleetloc
