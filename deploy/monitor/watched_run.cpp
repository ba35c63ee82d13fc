#include "deploy/monitor/watched_run.hpp"

#include <cmath>
#include <sstream>
#include <utility>

#include <Eigen/Eigenvalues>

namespace fleetloc {
namespace {

constexpr double kTrafficOver_s = 5.0;

std::string name_of(const std::filesystem::path& folder) {
  const auto clean = folder.lexically_normal();
  return (clean.has_filename() ? clean : clean.parent_path()).filename().string();
}

/// One sigma of the position of T_map_body.
double position_sigma_m(const CsvTail& line) {
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      covariance(i, j) = covariance(j, i) =
          line.number("cm" + std::to_string(i + 4) + std::to_string(j + 4));
    }
  }
  if (!covariance.allFinite()) return RobotView::kUnknown;
  return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvalues().z());
}

}  // namespace

WatchedRun::WatchedRun(const std::filesystem::path& folder, Trajectory truth)
    : summary_(folder / "summary.json"),
      truth_(std::move(truth)),
      diagnostics_(folder / "diagnostics.csv"),
      poses_(folder / "localization_frames.tum") {
  view_.name = name_of(folder);
}

const RobotView& WatchedRun::update() {
  view_.ended = std::filesystem::exists(summary_);  // first: it is written last
  read_diagnostics();
  read_error();
  return view_;
}

void WatchedRun::read_diagnostics() {
  diagnostics_.read([this] {
    const double stamp_s = diagnostics_.number("stamp_s");
    if (!first_stamp_s_) first_stamp_s_ = stamp_s;
    view_.time_s = stamp_s - *first_stamp_s_;
    view_.state = diagnostics_.text("state");
    view_.round_trip_s = diagnostics_.number("round_trip_s");
    view_.sigma_m = position_sigma_m(diagnostics_);
    add({.time_s = view_.time_s,
         .uplink_bytes = diagnostics_.number("uplink_bytes"),
         .downlink_bytes = diagnostics_.number("downlink_bytes")});
  });
}

void WatchedRun::add(const Traffic& traffic) {
  constexpr double kBytesPerKilobyte = 1000.0;
  traffic_.push_back(traffic);
  while (traffic.time_s - traffic_.front().time_s > kTrafficOver_s) traffic_.pop_front();
  const double interval_s = traffic.time_s - traffic_.front().time_s;
  if (interval_s <= 0.0) return;
  const double scale = 1.0 / (kBytesPerKilobyte * interval_s);
  view_.uplink_kb_s = scale * (traffic.uplink_bytes - traffic_.front().uplink_bytes);
  view_.downlink_kb_s = scale * (traffic.downlink_bytes - traffic_.front().downlink_bytes);
}

void WatchedRun::read_error() {
  constexpr Duration kMaxGap = std::chrono::milliseconds(150);
  const auto lines = poses_.new_lines();
  if (lines.empty()) return;
  std::istringstream stream(lines.back());
  double stamp_s = 0.0;
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
  stream >> stamp_s >> p_map.x() >> p_map.y() >> p_map.z();
  const auto T_map_body = interpolate(truth_, Timestamp(from_seconds(stamp_s)), kMaxGap);
  view_.error_m = stream && T_map_body ? (T_map_body->p - p_map).norm() : RobotView::kUnknown;
}

WatchedLocalizer::WatchedLocalizer(const std::filesystem::path& folder)
    : status_(folder / "status.csv") {
  view_.name = name_of(folder);
}

const LocalizerView& WatchedLocalizer::update() {
  status_.read([this] {
    view_.state = status_.text("state");
    view_.sessions = status_.text("sessions");
    view_.load = status_.number("load");
    view_.submaps = status_.text("submaps");
    view_.localized = status_.text("localized");
  });
  return view_;
}

}  // namespace fleetloc
