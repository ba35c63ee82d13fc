#include "deploy/monitor/served_fleet.hpp"

#include <chrono>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include "shared/geometry/covariance.hpp"

namespace fleetloc {
namespace {

using Json = nlohmann::json;

constexpr std::chrono::seconds kGone(5);   // of what a localizer tells twice a second
constexpr std::chrono::seconds kLeft(30);  // of a robot, which tells something every ten

Eigen::Matrix3d position_covariance(const ServedRobot& robot) {
  const Eigen::Matrix3d R = robot.T_map_body->R.toRotationMatrix();
  return R * robot.covariance.bottomRightCorner<3, 3>() * R.transpose();
}

double sigma_m(const ServedRobot& robot) {
  return max_sigma(position_covariance(robot));
}

// Of the body's axis that points least upwards: cameras and IMUs are mounted in any way.
double heading(const Pose& T_map_body) {
  const Eigen::Matrix3d R = T_map_body.R.toRotationMatrix();
  const int axis = std::abs(R(2, 0)) <= std::abs(R(2, 2)) ? 0 : 2;
  return std::atan2(R(1, axis), R(0, axis));
}

Json ellipse(const ServedRobot& robot) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver(
      position_covariance(robot).topLeftCorner<2, 2>());
  const Eigen::Vector2d half_axes = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  const Eigen::Vector2d direction = solver.eigenvectors().col(1);
  return {half_axes[1], half_axes[0], std::atan2(direction.y(), direction.x())};
}

std::string state_of(const LocalizerStatus& localizer) {
  if (localizer.draining) return "draining";
  return localizer.accepting ? "accepting" : "full";
}

// With how many places it may be at, if there are several.
std::string state_of(const ServedRobot& robot) {
  const std::string state(name(robot.quality));
  if (robot.possible_places.empty()) return state;
  return state + ", " + std::to_string(robot.possible_places.size()) + " places";
}

Json json_of(const ServedRobot& robot) {
  Json json{{"name", robot.robot},
            {"localizer", robot.localizer},
            {"state", name(robot.quality)},
            {"position", nullptr},
            {"up_bytes_per_s", std::lround(robot.up_bytes_per_s)},
            {"down_bytes_per_s", std::lround(robot.down_bytes_per_s)},
            {"silent_s", to_seconds(robot.silent)},
            {"round_trip_s", nullptr},
            {"possible_places", Json::array()}};
  for (const Eigen::Vector3d& p : robot.possible_places) {
    json["possible_places"].push_back({p.x(), p.y(), p.z()});
  }
  if (robot.round_trip) json["round_trip_s"] = to_seconds(*robot.round_trip);
  if (!robot.T_map_body) return json;
  const Eigen::Vector3d& p = robot.T_map_body->p;
  json["position"] = {p.x(), p.y(), p.z()};
  json["heading"] = heading(*robot.T_map_body);
  json["ellipse"] = ellipse(robot);
  json["sigma_m"] = sigma_m(robot);
  return json;
}

}  // namespace

void ServedFleet::add(const ServedRobot& robot, ArrivalTime now) {
  robots_[{robot.robot, robot.localizer}] = {.news = robot, .at = now};
}

void ServedFleet::add(const LocalizerStatus& localizer, ArrivalTime now) {
  localizers_[localizer.localizer] = {.news = localizer, .at = now};
}

void ServedFleet::forget_silent(ArrivalTime now) {
  const auto is_gone = [now](const auto& entry) { return now - entry.second.at > kGone; };
  std::erase_if(robots_, [&](const auto& entry) {
    return is_gone(entry) || now - entry.second.at + entry.second.news.silent > kLeft;
  });
  std::erase_if(localizers_, is_gone);
}

std::vector<ServedRobot> ServedFleet::robots() const {
  std::vector<ServedRobot> result;
  for (const auto& [id, heard] : robots_) {
    if (result.empty() || result.back().robot != heard.news.robot) {
      result.push_back(heard.news);
    } else if (heard.news.silent < result.back().silent) {
      result.back() = heard.news;
    }
  }
  return result;
}

std::vector<LocalizerStatus> ServedFleet::localizers() const {
  std::vector<LocalizerStatus> result;
  for (const auto& [name, heard] : localizers_) result.push_back(heard.news);
  return result;
}

FleetView view_of(const ServedFleet& fleet) {
  FleetView view;
  for (const ServedRobot& robot : fleet.robots()) {
    RobotView one{.name = robot.robot,
                  .state = state_of(robot),
                  .uplink_kb_s = 1e-3 * robot.up_bytes_per_s,
                  .downlink_kb_s = 1e-3 * robot.down_bytes_per_s};
    if (robot.T_map_body) one.sigma_m = sigma_m(robot);
    if (robot.round_trip) one.round_trip_s = to_seconds(*robot.round_trip);
    view.robots.push_back(std::move(one));
  }
  for (const LocalizerStatus& localizer : fleet.localizers()) {
    view.localizers.push_back({.name = localizer.localizer,
                               .state = state_of(localizer),
                               .sessions = std::to_string(localizer.sessions),
                               .load = localizer.load,
                               .submaps = {},
                               .localized = {}});
  }
  return view;
}

std::string json_of(const ServedFleet& fleet) {
  Json json{{"robots", Json::array()}, {"localizers", Json::array()}};
  for (const ServedRobot& robot : fleet.robots()) json["robots"].push_back(json_of(robot));
  for (const LocalizerStatus& localizer : fleet.localizers()) {
    json["localizers"].push_back({{"name", localizer.localizer},
                                  {"state", state_of(localizer)},
                                  {"robots", localizer.sessions},
                                  {"load", localizer.load}});
  }
  return json.dump();
}

}  // namespace fleetloc
