#include "deploy/evaluation/experiment/experiment.hpp"

#include <algorithm>
#include <iostream>
#include <set>
#include <thread>

#include "deploy/evaluation/experiment/experiment_report.hpp"
#include "deploy/evaluation/experiment/inputs.hpp"
#include "deploy/evaluation/experiment/results.hpp"
#include "deploy/evaluation/experiment/run.hpp"
#include "deploy/evaluation/experiment/schedule.hpp"
#include "shared/config/output_folder.hpp"
#include "shared/config/progress_line.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

/// On a terminal how far it is; a line for each piece that has ended, in a pipe as well.
void carry_out(const std::string& what,
               const std::vector<Task>& tasks,
               int jobs,
               const std::stop_token& stop) {
  if (tasks.empty()) return;
  ProgressLine progress(what);
  std::size_t done = 0;
  progress.show(done, tasks.size());
  run_tasks(tasks, jobs, stop, [&](const Task&, const std::string& line) {
    ++done;
    progress.clear();
    std::cout << what << ' ' << done << '/' << tasks.size() << "  " << line << std::endl;
    progress.show(done, tasks.size());
  });
}

/// Runs that depend on the same things are made once.
std::vector<Task> missing_runs(const std::vector<Run>& runs, const RunContext& context) {
  std::vector<Task> tasks;
  std::set<std::string> known;
  for (const Run& run : runs) {
    if (!known.insert(run.identity).second) continue;
    if (fs::exists(finished_folder(context.runs, run))) continue;
    tasks.push_back({run.name(), [&run, &context](const std::stop_token& stop, int slot) {
                       return run.name() + ": " + perform(run, context, stop, slot);
                     }});
  }
  return tasks;
}

}  // namespace

ExperimentCounts run_experiment(const Plan& plan,
                                const Programs& programs,
                                const ExperimentOptions& options,
                                const std::stop_token& stop) {
  const OutputFolder own(options.out);
  fs::create_directories(options.out / "runs");
  const Inputs inputs(plan, programs, options.store);
  const std::vector<Run> runs = runs_of(plan, inputs, programs);
  const RunContext context{
      .plan = &plan, .inputs = &inputs, .programs = &programs, .runs = options.out / "runs"};
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  carry_out(
      "dataset", inputs.missing_datasets(std::max(1, cores / options.jobs)), options.jobs, stop);
  if (!stop.stop_requested()) carry_out("map", inputs.missing_maps(), options.jobs, stop);
  if (!stop.stop_requested()) {
    const auto tasks = missing_runs(runs, context);
    std::cout << runs.size() << " runs, " << tasks.size() << " to be made" << std::endl;
    carry_out("run", tasks, options.jobs, stop);
  }
  const std::vector<Result> results = read_results(runs, context.runs);
  write_text(options.out / "results.csv", results_csv(results));
  write_text(options.out / "report.html",
             experiment_page(plan, text_of(options.plan_file), results, inputs, runs.size()));
  std::cout << error_lines(results);
  ExperimentCounts counts{.runs = runs.size()};
  for (const Result& result : results) ++(result.failure.empty() ? counts.finished : counts.failed);
  return counts;
}

}  // namespace fleetloc
