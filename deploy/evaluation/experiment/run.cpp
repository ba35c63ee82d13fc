#include "deploy/evaluation/experiment/run.hpp"

#include <sstream>

#include <nlohmann/json.hpp>

#include "deploy/evaluation/experiment/draw_trials.hpp"
#include "deploy/evaluation/experiment/fingerprint.hpp"
#include "deploy/evaluation/experiment/initial_pose.hpp"
#include "deploy/evaluation/experiment/player.hpp"
#include "shared/core/exact_text.hpp"

namespace fleetloc {
namespace {

namespace fs = std::filesystem;

std::string identity_of(const Run& run,
                        const Plan& plan,
                        const Inputs& inputs,
                        const Programs& programs) {
  Fingerprint fingerprint;
  const bool dds = plan.mode == Mode::kDds;
  fingerprint.add("eval", programs.fingerprint("eval"))
      .add(dds ? "robot" : "replay", programs.fingerprint(dds ? "robot" : "replay"))
      .add("dataset", inputs.dataset(run.dataset->name).identity)
      .add("tracks", run.dataset->plays_tracks() ? "yes" : "no")
      .add("start", exact_text(run.start_s))
      .add("duration", plan.duration_s ? exact_text(*plan.duration_s) : "all")
      .add("configuration", run.configuration->yaml);
  if (dds) {
    fingerprint.add("cloud", programs.fingerprint("cloud"))
        .add_file("qos", qos_of(*run.configuration, *plan.dds))
        .add("rate", exact_text(plan.dds->rate));
  }
  if (!run.dataset->faults.empty()) fingerprint.add("faults", run.dataset->faults);
  if (run.configuration->odometry_only) return fingerprint.text();  // the rest has no effect
  return fingerprint.add("map", inputs.map(run.dataset->map).identity)
      .add("align once", run.configuration->align_once ? "yes" : "no")
      .add("localizers", run.configuration->localizers)
      .add("baseline", run.configuration->icp_baseline ? "icp" : "none")
      .add("link", link_yaml(link_of(run)))
      .add("told", run.is_told ? "yes" : "no")
      .add("start position error", exact_text(plan.start_error.position_m))
      .add("start yaw error", exact_text(plan.start_error.yaw_deg))
      .text();
}

void evaluate(const fs::path& folder,
              const Run& run,
              const RunContext& context,
              const std::stop_token& stop) {
  run_program({context.programs->path("eval"),
               "--run",
               folder.string(),
               "--ground-truth",
               context.inputs->dataset(run.dataset->name).ground_truth.string()},
              folder / "evaluation.txt",
              stop);
}

void write_description(const fs::path& folder,
                       const Run& run,
                       int exit_status,
                       const std::string& failure) {
  const nlohmann::json description = {{"dataset", run.dataset->name},
                                      {"configuration", run.configuration->name},
                                      {"link", run.link->name},
                                      {"seed", run.seed},
                                      {"start_s", run.start_s},
                                      {"identity", run.identity},
                                      {"exit_status", exit_status},
                                      {"failure", failure}};
  write_text(folder / "run.json", description.dump(2) + "\n");
}

/// A program that is ended by a signal leaves results of what it has played, and calls it success.
void expect_whole(const fs::path& folder) {
  const auto summary = nlohmann::json::parse(text_of(folder / "summary.json"));
  constexpr int kSignal = -1;
  if (summary.value("interrupted", false)) {
    throw ProgramFailed("was interrupted before the end of the dataset", kSignal);
  }
}

std::string outcome_line(const fs::path& folder) {
  const auto evaluation = nlohmann::json::parse(text_of(folder / "evaluation.json"));
  std::ostringstream line;
  line.precision(3);
  const auto& ate = evaluation.at("ate");
  if (ate.is_null()) {
    line << "never localized";
  } else {
    line << "error median " << ate.at("median").get<double>() << " m, max "
         << ate.at("max").get<double>() << " m";
  }
  return line.str();
}

/// In seconds of the dataset.
std::vector<double> starts_of(const DatasetSpec& dataset, const Plan& plan) {
  if (!dataset.starts) return {plan.start_s};
  return drawn_starts(*dataset.starts);
}

}  // namespace

std::string Run::name() const {
  std::string name = dataset->name + " " + configuration->name + " " + link->name + " seed " +
                     std::to_string(seed);
  if (dataset->starts) name += " from " + exact_text(start_s) + " s";
  return name;
}

LinkConfig link_of(const Run& run) {
  LinkConfig link = run.configuration->icp_baseline ? perfect_link() : run.link->link;
  link.seed = run.seed;
  return link;
}

std::vector<Run> runs_of(const Plan& plan, const Inputs& inputs, const Programs& programs) {
  std::vector<Run> runs;
  for (const DatasetSpec& dataset : plan.datasets) {
    for (const ConfigurationSpec& configuration : plan.configurations) {
      for (const LinkSpec& link : plan.links) {
        for (const std::uint64_t seed : plan.seeds) {
          for (const double start_s : starts_of(dataset, plan)) {
            Run run{.dataset = &dataset,
                    .configuration = &configuration,
                    .link = &link,
                    .seed = seed,
                    .start_s = start_s,
                    .is_told = !dataset.starts.has_value(),
                    .identity = {}};
            run.identity = identity_of(run, plan, inputs, programs);
            runs.push_back(run);
          }
        }
      }
    }
  }
  return runs;
}

fs::path finished_folder(const fs::path& runs, const Run& run) {
  return runs / run.identity;
}

fs::path failed_folder(const fs::path& runs, const Run& run) {
  return runs / (run.identity + ".failed");
}

std::string perform(const Run& run,
                    const RunContext& context,
                    const std::stop_token& stop,
                    int slot) {
  const fs::path finished = finished_folder(context.runs, run);
  const fs::path failed = failed_folder(context.runs, run);
  fs::remove_all(failed);
  std::string line;
  bool has_failed = false;
  make_folder(finished, [&](const fs::path& part) {
    try {
      play(run, context, {.folder = part, .slot = slot}, stop);
      expect_whole(part);
      evaluate(part, run, context, stop);
      write_description(part, run, 0, "");
      line = outcome_line(part);
    } catch (const ProgramFailed& error) {
      write_description(part, run, error.exit_code(), error.what());
      line = std::string("failed: ") + error.what();
      has_failed = true;
    }
  });
  if (has_failed) fs::rename(finished, failed);
  return line;
}

}  // namespace fleetloc
