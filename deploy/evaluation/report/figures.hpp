#pragma once

#include <span>
#include <string>
#include <vector>

#include "deploy/evaluation/report/run_data.hpp"

namespace fleetloc {

/// The longest gap that a line is drawn across.
inline constexpr double kLongestGap_s = 1.0;

/// Figures of one run, as <svg> elements whose ids begin with `id`. Empty: the run has nothing to
/// show there. All throw std::runtime_error, see gnuplot_output().
struct TrajectoryFigures {
  std::string localized;
  std::string aligned_once;
  std::string odometry;
};

/// Seen from above and coloured by the error of position, one view and one scale for all three.
TrajectoryFigures trajectory_figures(const RunErrors& errors,
                                     std::span<const Eigen::Vector3f> map,
                                     const std::string& id);

/// Without ground truth: localized and aligned once, in one figure.
std::string trajectory_figure(const RunData& run,
                              std::span<const Eigen::Vector3f> map,
                              const std::string& id);

/// Errors of position of all three over time, logarithmic.
std::string comparison_figure(const RunData& run, const RunErrors& errors, const std::string& id);

/// Error of x, y, z and yaw over time within three sigmas of the stated covariance.
struct ConsistencyFigure {
  std::string svg;
  double share_within = 0.0;  ///< of all components of all frames, inside of three sigmas
};
ConsistencyFigure consistency_figure(const RunData& run,
                                     const RunErrors& errors,
                                     const std::string& id);

std::string bytes_figure(const RunData& run, const std::string& id);
std::string link_figure(const RunData& run, const std::string& id);
std::string states_figure(const RunData& run, const std::string& id);

/// Times of an optimization: one row a robot and localizer.
struct SessionRow {
  std::string name;
  double p50_ms;
  double p99_ms;
};
std::string session_figure(const std::vector<SessionRow>& rows, const std::string& id);

}  // namespace fleetloc
