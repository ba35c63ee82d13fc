#include "cloud/pool/sessions_report.hpp"

#include <fstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "shared/core/percentile.hpp"

namespace fleetloc {
namespace {

nlohmann::json percentile_json(const std::vector<double>& values, double share) {
  const auto value = percentile(values, share);
  return value ? nlohmann::json(*value) : nlohmann::json(nullptr);
}

nlohmann::json to_json(const SessionReport& report) {
  return {{"submaps", report.submaps},
          {"localized", report.localized},
          {"rejected", report.rejected},
          {"refused", report.refused},
          {"optimize_ms",
           {{"p50", percentile_json(report.optimize_ms, 0.5)},
            {"p99", percentile_json(report.optimize_ms, 0.99)}}},
          {"matches", {{"p50", percentile_json(report.matches, 0.5)}}},
          {"memory_bytes", report.memory_bytes}};
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
