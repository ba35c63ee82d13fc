#include "deploy/evaluation/report/eval_report.hpp"

#include <fstream>
#include <stdexcept>

#include "shared/trajectory/tum_file.hpp"

namespace fleetloc {
namespace {

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::error_code error;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), error);
  std::ofstream stream(file);
  stream << text;
  stream.close();
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
}

nlohmann::json earlier_evaluation(const std::filesystem::path& folder) {
  const auto file = folder / "evaluation.json";
  std::ifstream stream(file);
  if (!stream) return nullptr;
  try {
    return nlohmann::json::parse(stream);
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

}  // namespace

void check(const RunArguments& arguments) {
  if (arguments.truths.empty() && arguments.report.empty()) {
    throw std::invalid_argument("--ground-truth is required; only a --report can do without");
  }
  const std::size_t truths = arguments.truths.size();
  if (truths > 1 && truths != arguments.runs.size()) {
    throw std::invalid_argument("--ground-truth: " + std::to_string(truths) + " files for " +
                                std::to_string(arguments.runs.size()) +
                                " runs; give one for all of them, or one for each");
  }
  for (const std::string& run : arguments.runs) {
    if (!std::filesystem::is_directory(run)) throw std::invalid_argument(run + ": no such folder");
  }
  std::vector<std::string> files = arguments.sessions;
  if (!arguments.map.empty()) files.push_back(arguments.map);
  for (const std::string& file : files) {
    if (!std::filesystem::is_regular_file(file)) {
      throw std::invalid_argument(file + ": no such file");
    }
  }
}

std::vector<ReportRun> opened_runs(const RunArguments& arguments) {
  std::vector<Trajectory> truths;
  for (const std::string& file : arguments.truths) {
    truths.push_back(read_trajectory(file));
    if (truths.back().empty()) throw TrajectoryFileError(file + ": holds no poses");
  }
  std::vector<ReportRun> runs;
  for (std::size_t i = 0; i < arguments.runs.size(); ++i) {
    ReportRun run{.folder = arguments.runs[i], .evaluation = nullptr, .truth = std::nullopt};
    if (!truths.empty()) run.truth = truths[truths.size() == 1 ? 0 : i];
    runs.push_back(std::move(run));
  }
  return runs;
}

void evaluate_all(std::vector<ReportRun>& runs, const EvaluationConfig& config) {
  for (ReportRun& run : runs) {
    if (!run.truth) {
      run.evaluation = earlier_evaluation(run.folder);
      continue;
    }
    run.evaluation = evaluate_run(run.folder, *run.truth, config);
    write_text(run.folder / "evaluation.json", run.evaluation.dump(2) + "\n");
  }
}

std::size_t write_report(const RunArguments& arguments,
                         const std::vector<ReportRun>& runs,
                         const EvaluationConfig& config) {
  ReportInput input{.runs = runs, .map = std::nullopt, .sessions = {}, .max_gap = config.max_gap};
  if (!arguments.map.empty()) input.map = arguments.map;
  input.sessions.assign(arguments.sessions.begin(), arguments.sessions.end());
  const std::string page = report_page(input);
  write_text(arguments.report, page);
  return page.size();
}

}  // namespace fleetloc
