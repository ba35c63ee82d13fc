// fleetloc-experiment: runs a matrix of datasets, configurations, links and seeds.
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include "cloud/pool/localizer_pool.hpp"
#include "deploy/config/default_config.hpp"
#include "deploy/evaluation/experiment/experiment.hpp"
#include "deploy/replay/icp_localizer.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "robot/pipeline/robot_pipeline.hpp"
#include "shared/concurrency/termination.hpp"
#include "shared/config/program.hpp"

namespace {

using namespace fleetloc;

/// As the programs under test read it.
void check_configuration(const ConfigReader& config) {
  ConfigReader reader = config;
  static_cast<void>(read_robot_pipeline_config(config));
  static_cast<void>(read_keyframe_worker_config(config));
  static_cast<void>(read_cloud_client_config(reader.section("client")));
  static_cast<void>(read_localizer_pool_config(config));
  static_cast<void>(read_icp_localizer_config(reader.section("icp_baseline")));
}

std::filesystem::path own_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

int report(const ExperimentCounts& counts, const std::filesystem::path& out, bool stopped) {
  std::cout << counts.finished << " of " << counts.runs << " runs finished";
  if (counts.failed > 0) std::cout << ", " << counts.failed << " failed";
  std::cout << ": " << (out / "results.csv").string() << ", " << (out / "report.html").string()
            << '\n';
  if (stopped) std::cout << "interrupted: the same command continues\n";
  return counts.finished == counts.runs ? kSuccess : kFailedAtRunTime;
}

}  // namespace

int main(int argc, char** argv) {
  return fleetloc::guarded([&] {
    Program program("fleetloc-experiment",
                    "Runs a matrix of datasets, configurations, links and seeds, and compares each "
                    "run with ground truth and controls. What is finished is kept.",
                    default_config("everything"));
    ExperimentOptions options;
    std::string plan_file;
    std::string out;
    std::string store;
    options.jobs = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    CLI::App& app = program.options();
    app.add_option("--plan", plan_file, "YAML, see deploy/experiments")->required();
    app.add_option("--out", out, "folder for runs, results.csv and report.html, is created")
        ->required();
    app.add_option("--jobs", options.jobs, "runs at a time (number of cores)")
        ->check(CLI::Range(1, 1024));
    app.add_option("--store", store, "datasets and maps that are made (those of --out)");
    return program.run(argc, argv, [&] {
      auto termination = std::make_shared<Termination>();  // before any thread
      const auto absolute = [](const std::string& path) {
        return std::filesystem::absolute(path).lexically_normal();
      };
      options.plan_file = plan_file;
      options.out = absolute(out);
      options.store = store.empty() ? options.out : absolute(store);
      auto plan = std::make_shared<const Plan>(read_plan(plan_file, check_configuration));
      if (plan->dds && plan->dds->first_domain + options.jobs > 101) {
        throw std::invalid_argument("--jobs: there are DDS domains up to 100 only");
      }
      auto programs = std::make_shared<const Programs>(own_folder());
      return [plan, programs, options, termination] {
        const auto counts = run_experiment(*plan, *programs, options, termination->token());
        return report(counts, options.out, termination->token().stop_requested());
      };
    });
  });
}
