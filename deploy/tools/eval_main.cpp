// fleetloc-eval: compares an estimate or a run with the ground truth.
#include <algorithm>
#include <array>
#include <cstdint>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "deploy/config/default_config.hpp"
#include "deploy/evaluation/errors/eval_run.hpp"
#include "deploy/evaluation/report/eval_report.hpp"
#include "shared/config/program.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/geometry/pose_text.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/trajectory/tum_file.hpp"

namespace {

using namespace fleetloc;

struct Options {
  RunArguments runs;
  std::string estimate;
  std::string alignment = "none";
  bool json = false;
  std::optional<std::int64_t> pose_at_ns;
  std::array<double, 4> displaced{};  // x, y, z [m], yaw [deg]
};

Trajectory read_poses(const std::string& file) {
  Trajectory trajectory = read_trajectory(file);
  if (trajectory.empty()) throw TrajectoryFileError(file + ": holds no poses");
  return trajectory;
}

void print_row(const std::string& name, const nlohmann::json& statistics) {
  std::cout << name;
  for (const char* key : {"median", "mean", "rmse", "std", "max"}) {
    std::cout << "  " << key << ' ' << statistics.at(key).get<double>();
  }
  std::cout << '\n';
}

int print(const nlohmann::json& evaluation, bool json) {
  if (json) {
    std::cout << evaluation.dump(2) << '\n';
  } else {
    std::cout << evaluation.at("poses") << " poses compared, " << evaluation.at("unmatched")
              << " without ground truth\n";
    print_row("translation [m]  ", evaluation.at("translation_m"));
    print_row("rotation [deg]   ", evaluation.at("rotation_deg"));
  }
  return kSuccess;
}

/// A start pose for a robot whose start is only roughly known: the truth, displaced in the map.
int print_start_pose(const Trajectory& truth, const Options& options) {
  const Timestamp stamp{Duration{*options.pose_at_ns}};
  const auto nearest = std::ranges::min_element(
      truth, {}, [&](const StampedPose& pose) { return std::abs((pose.stamp - stamp).count()); });
  const auto& [x, y, z, yaw_deg] = options.displaced;
  Pose T_map_body = nearest->T_ref_body;
  T_map_body.p += Eigen::Vector3d(x, y, z);
  T_map_body.R = exp_so3(Eigen::Vector3d(0.0, 0.0, yaw_deg * kRadPerDeg)) * T_map_body.R;
  std::cout << pose_text(T_map_body) << '\n';
  return kSuccess;
}

void print_state(const nlohmann::json& evaluation) {
  std::cout << "covered  " << evaluation.at("covered") << "  coverage  "
            << evaluation.at("coverage") << '\n';
  const auto& confidence = evaluation.at("confidence");
  if (confidence.is_null()) return;
  std::cout << "localized frames  " << confidence.at("localized_frames") << "  wrong "
            << confidence.at("wrong") << "  confidently " << confidence.at("confidently_wrong")
            << "  worst " << confidence.at("worst_m") << " m, " << confidence.at("worst_deg")
            << " deg\n";
}

void print_run(const nlohmann::json& evaluation) {
  for (const char* key : {"ate", "rotation_deg", "odometry_ate", "odometry_rotation_deg"}) {
    if (!evaluation.at(key).is_null()) print_row(key, evaluation.at(key));
  }
  if (const auto& control = evaluation.at("aligned_once"); !control.is_null()) {
    print_row("aligned_once", control.at("ate"));
    std::cout << "aligned_once / ate  median " << control.at("ratio").at("median") << "  rmse "
              << control.at("ratio").at("rmse") << '\n';
  }
  if (const auto& relative = evaluation.at("odometry_relative"); !relative.is_null()) {
    std::cout << "odometry_relative  rmse " << relative.at("translation_rmse_m") << " m, "
              << relative.at("rotation_rmse_deg") << " deg over " << relative.at("pairs")
              << " pairs\n";
  }
  print_state(evaluation);
  std::cout << "nees  map " << evaluation.at("nees").at("map") << "  odom "
            << evaluation.at("nees").at("odom") << '\n';
}

/// The evaluation of one run, or of several by their folders.
void print_json(const std::vector<ReportRun>& runs) {
  nlohmann::json all;
  for (const ReportRun& run : runs) all[run.folder.string()] = run.evaluation;
  std::cout << (runs.size() == 1 ? runs.front().evaluation : all).dump(2) << '\n';
}

int treat_runs(std::vector<ReportRun>& runs,
               const Options& options,
               const EvaluationConfig& config) {
  evaluate_all(runs, config);
  if (options.json) {
    print_json(runs);
  } else {
    for (const ReportRun& run : runs) {
      if (runs.size() > 1) std::cout << "== " << run.folder.string() << '\n';
      if (run.truth) print_run(run.evaluation);
    }
  }
  if (options.runs.report.empty()) return kSuccess;
  const std::size_t bytes = write_report(options.runs, runs, config);
  if (!options.json) std::cout << options.runs.report << ": " << bytes << " bytes\n";
  return kSuccess;
}

Alignment alignment_named(const std::string& name) {
  if (name == "yaw") return Alignment::kYaw;
  return name == "se3" ? Alignment::kSe3 : Alignment::kNone;
}

void add_options(CLI::App& app, Options& options) {
  app.add_option("--ground-truth",
                 options.runs.truths,
                 "TUM file, or EuRoC's data.csv; of several runs one for all or one for each");
  auto* estimate = app.add_option("--estimate", options.estimate, "TUM file");
  app.add_option("--align", options.alignment, "none (default), yaw or se3")
      ->check(CLI::IsMember({"none", "yaw", "se3"}))
      ->needs(estimate);
  auto* run = app.add_option("--run", options.runs.runs, "run folders; evaluation.json is added")
                  ->excludes(estimate);
  auto* report =
      app.add_option("--report", options.runs.report, "HTML file: figures and tables of the runs")
          ->needs(run);
  app.add_option("--map", options.runs.map, "laser map, to be drawn in the report")->needs(report);
  app.add_option("--sessions", options.runs.sessions, "sessions.json of localizers, for the report")
      ->needs(report);
  app.add_flag("--json", options.json, "Print JSON instead of a table");
  auto* at = app.add_option("--pose-at-ns",
                            options.pose_at_ns,
                            "print the ground-truth pose nearest to this stamp, as a start pose")
                 ->excludes(estimate);
  app.add_option("--displaced",
                 options.displaced,
                 "\"x y z yaw\" [m, deg] by which that pose is displaced in the map")
      ->delimiter(' ')
      ->needs(at);
}

/// Without a run folder: an estimate, or a start pose.
Program::Run prepared_comparison(const Program& program, const Options& options) {
  if (!options.pose_at_ns && options.estimate.empty()) {
    throw std::invalid_argument("--estimate, --run or --pose-at-ns is required");
  }
  if (options.runs.truths.size() != 1) {
    throw std::invalid_argument("--ground-truth is required, one file");
  }
  const Trajectory truth = read_poses(options.runs.truths.front());
  if (options.pose_at_ns) return [=] { return print_start_pose(truth, options); };
  const auto config = read_evaluation_config(program.config().section("evaluation"));
  const Trajectory estimate = read_poses(options.estimate);
  const Alignment alignment = alignment_named(options.alignment);
  return [=] { return print(evaluate(truth, estimate, alignment, config), options.json); };
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    Program program("fleetloc-eval",
                    "Compares an estimate or a run with the ground truth.",
                    default_config("everything"));
    Options options;
    add_options(program.options(), options);
    return program.run(argc, argv, [&]() -> Program::Run {
      if (options.runs.runs.empty()) return prepared_comparison(program, options);
      check(options.runs);
      const auto config = read_evaluation_config(program.config().section("evaluation"));
      return [=, runs = opened_runs(options.runs)]() mutable {
        return treat_runs(runs, options, config);
      };
    });
  });
}
