#include "cloud/pool/sessions_report.hpp"

#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "shared/core/percentile.hpp"

namespace fleetloc {
namespace {

nlohmann::json percentile_json(const RecentValues& values, double share) {
  const auto value = percentile(values.values(), share);
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

nlohmann::json to_json(const std::optional<RobotStatus>& status) {
  if (!status) return nullptr;
  return {{"state", name(status->quality)},
          {"submaps_sent", status->submaps_sent},
          {"answers_applied", status->answers_applied},
          {"round_trip_s",
           status->round_trip ? nlohmann::json(to_seconds(*status->round_trip))
                              : nlohmann::json(nullptr)}};
}

nlohmann::json to_json(const std::vector<Eigen::Vector3d>& places) {
  nlohmann::json json = nlohmann::json::array();
  for (const Eigen::Vector3d& p : places) json.push_back({p.x(), p.y(), p.z()});
  return json;
}

nlohmann::json to_json(const SearchReport& report) {
  return {
      {"searches", report.searches},
      {"explained", report.searches > 0 ? nlohmann::json(report.explained) : nullptr},
      {"places_left", report.places_left},
      {"possible_places", to_json(report.possible_places)},
      {"ms", {{"p50", percentile_json(report.ms, 0.5)}, {"max", percentile_json(report.ms, 1.0)}}}};
}

nlohmann::json to_json(const SessionReport& report) {
  return {{"sessions", report.sessions},
          {"submaps", report.submaps},
          {"localized", report.localized},
          {"rejected", report.rejected},
          {"refused", report.refused},
          {"optimize_ms",
           {{"p50", percentile_json(report.optimize_ms, 0.5)},
            {"p99", percentile_json(report.optimize_ms, 0.99)}}},
          {"matches", {{"p50", percentile_json(report.matches, 0.5)}}},
          {"memory_bytes", report.memory_bytes},
          {"search", to_json(report.search)},
          {"last_error", report.last_error},
          {"status", to_json(report.status)}};
}

}  // namespace

void write_sessions(const std::filesystem::path& file,
                    const std::map<RobotId, SessionReport>& reports) {
  nlohmann::json sessions = nlohmann::json::object();
  for (const auto& [robot, report] : reports) sessions[robot] = to_json(report);
  std::ofstream stream(file);
  stream << sessions.dump(2) << '\n';
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace fleetloc
