#include "robot/node/ros2_diagnostics.hpp"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <sstream>
#include <utility>

#include "shared/geometry/angle.hpp"
#include "shared/ros2/ros2_names.hpp"

namespace fleetloc {
namespace {

using Level = DiagnosticStatus::Level;

std::string text(double number) {
  std::ostringstream stream;
  stream << number;
  return stream.str();
}

Level level_of(Quality quality) {
  switch (quality) {
    case Quality::kLocalized:
      return Level::kOk;
    case Quality::kInitializing:
    case Quality::kDeadReckoning:
    case Quality::kSearching:
      return Level::kWarning;
    case Quality::kLost:
      return Level::kError;
  }
  return Level::kError;
}

/// One sigma of a position [m], over all directions.
double position_sigma(const Matrix6d& covariance) {
  return std::sqrt(covariance.bottomRightCorner<3, 3>().trace());
}

DiagnosticStatus localization(const RobotState& state) {
  const std::optional<PoseEstimate>& pose = state.pose;
  const Quality quality = pose ? pose->quality : Quality::kInitializing;
  DiagnosticStatus status{.level = level_of(quality),
                          .component = "fleetloc: localization",
                          .message = std::string(name(quality)),
                          .hardware = {},
                          .values = {}};
  if (!pose) return status;
  status.values = {{"odom_sigma_m", text(position_sigma(pose->covariance_odom))}};
  if (pose->T_map_body) {
    status.values.emplace_back("map_sigma_m", text(position_sigma(pose->covariance_map)));
    status.values.emplace_back("since_last_answer_s", text(to_seconds(pose->since_last_answer)));
  }
  if (!state.answer) return status;
  status.values.emplace_back("localizer", state.answer->answer.localizer);
  status.values.emplace_back("last_answer", std::string(name(state.answer->outcome)));
  if (const int places = state.answer->answer.places; places > 0) {
    status.values.emplace_back("possible_places", std::to_string(places));
  }
  if (const auto& innovation = state.answer->innovation) {
    const double angle_rad = innovation->head<3>().norm();
    status.values.emplace_back("innovation_m", text(innovation->tail<3>().norm()));
    status.values.emplace_back("innovation_deg", text(angle_rad / kRadPerDeg));
  }
  return status;
}

DiagnosticStatus sensor_status(const SensorState& sensors) {
  DiagnosticStatus status{.level = Level::kOk,
                          .component = "fleetloc: sensors",
                          .message = "all topics come",
                          .hardware = {},
                          .values = {}};
  if (!sensors.silent_topics.empty()) {
    status.level = Level::kError;
    status.message = "no messages on";
    for (const std::string& topic : sensors.silent_topics) status.message += " " + topic;
  }
  for (const auto& [kind, count] : sensors.faults) {
    if (count > 0) status.values.emplace_back(kind, std::to_string(count));
  }
  return status;
}

DiagnosticStatus link(const LinkTraffic& traffic) {
  const bool is_answered = traffic.round_trip.has_value();
  DiagnosticStatus status{.level = is_answered ? Level::kOk : Level::kWarning,
                          .component = "fleetloc: link",
                          .message = is_answered ? "a localizer answers" : "no answer yet",
                          .hardware = {},
                          .values = {{"submaps_sent", std::to_string(traffic.submaps_sent)},
                                     {"uplink_bytes", std::to_string(traffic.uplink_bytes)},
                                     {"downlink_bytes", std::to_string(traffic.downlink_bytes)},
                                     {"loss", text(traffic.loss)}}};
  if (traffic.round_trip) {
    status.values.emplace_back("round_trip_s", text(to_seconds(*traffic.round_trip)));
  }
  return status;
}

}  // namespace

std::vector<DiagnosticStatus> robot_diagnostics(const std::string& robot,
                                                const RobotState& state,
                                                const SensorState& sensors) {
  std::vector<DiagnosticStatus> statuses{
      localization(state), sensor_status(sensors), link(state.traffic)};
  for (DiagnosticStatus& status : statuses) status.hardware = robot;
  return statuses;
}

Ros2Diagnostics::Ros2Diagnostics(std::string robot,
                                 Ros2Participant& participant,
                                 std::function<SensorState()> sensors)
    : robot_(std::move(robot)),
      sensors_(std::move(sensors)),
      writer_(participant.create_writer(
          {.name = "rt/diagnostics", .type = ros2_type::kDiagnostics, .qos = Ros2Qos::kDefault})),
      thread_([this](const std::stop_token& stop) { publish(stop); }) {}

void Ros2Diagnostics::add(const RobotOutput& output) {
  const std::lock_guard lock(mutex_);
  if (output.pose) state_.pose = output.pose;
  if (!output.answers.empty()) state_.answer = output.answers.back();
  state_.traffic = output.traffic;
}

void Ros2Diagnostics::publish(const std::stop_token& stop) {
  constexpr std::chrono::seconds kInterval(1);
  std::mutex mutex;
  std::condition_variable_any never;  // only a stop ends a wait early
  while (!stop.stop_requested()) {
    writer_.write(message());
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, kInterval, [] { return false; });
  }
}

// The time of day, as other nodes have it: the sensors' may stand still.
Bytes Ros2Diagnostics::message() const {
  const SensorState sensors = sensors_();
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const std::lock_guard lock(mutex_);
  return encode(DiagnosticsMessage{.header = {.stamp = Timestamp(now), .frame = {}},
                                   .statuses = robot_diagnostics(robot_, state_, sensors)});
}

}  // namespace fleetloc
