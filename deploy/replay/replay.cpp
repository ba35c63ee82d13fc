#include "deploy/replay/replay.hpp"

#include <memory>
#include <utility>

#include "cloud/laser_map/map_file.hpp"
#include "cloud/locate/pyramid_config.hpp"
#include "deploy/faults/fault_injector.hpp"
#include "deploy/replay/align_once.hpp"
#include "deploy/replay/localizer_decorator.hpp"
#include "deploy/replay/sample_recorder.hpp"
#include "deploy/replay/simulated_back_end.hpp"
#include "deploy/replay/simulated_localizers.hpp"
#include "robot/dataset/dataset_reader.hpp"
#include "robot/run_folder/run_recorder.hpp"
#include "robot/runtime/robot_runtime.hpp"
#include "shared/core/cpu_time.hpp"
#include "shared/link/memory_network.hpp"

namespace fleetloc {
namespace {

constexpr const char* kRobot = "robot";

/// The localization behind the robot's MapLocalizer, in simulated time.
class Localization {
 public:
  Localization() = default;
  virtual ~Localization() = default;
  Localization(const Localization&) = delete;
  Localization& operator=(const Localization&) = delete;

  [[nodiscard]] virtual MapLocalizer& localizer() = 0;
  virtual void finish(const std::filesystem::path&) const {}
};

/// The robot's client, which takes the far side of the network along with its time.
class SimulatedClient final : public LocalizerDecorator {
 public:
  SimulatedClient(CloudClient& client, SimulatedLocalizers& cloud)
      : LocalizerDecorator(client), cloud_(cloud) {}

  void update(Timestamp now, Quality quality) override {
    LocalizerDecorator::update(now, quality);
    cloud_.advance(now);
  }

 private:
  SimulatedLocalizers& cloud_;
};

std::unique_ptr<Channel> robot_end(MemoryNetwork& network, const ReplayOptions& options) {
  std::unique_ptr<Channel> end = network.join_robot(kRobot);
  if (!options.samples) return end;
  return std::make_unique<SampleRecorder>(std::move(end), *options.samples);
}

/// Link and cloud.
class Cloud final : public Localization {
 public:
  Cloud(const ReplayOptions& options, const ReplayConfig& config)
      : network_(options.link),
        robot_end_(robot_end(network_, options)),
        map_(std::make_shared<const LaserMap>(load_map(*options.map))),
        cloud_(network_,
               map_,
               prepare_pyramid(*map_, *options.map, config.pool.pyramid).pyramid,
               {.pool = config.pool,
                .regions = load_map_regions(*options.map),
                .localization_time = from_seconds(config.durations.localization_s),
                .cpu_clock = thread_cpu_time},
               options.localizers),
        client_(kRobot, *robot_end_, config.client),
        localizer_(client_, cloud_) {}

  MapLocalizer& localizer() override { return localizer_; }
  void finish(const std::filesystem::path& out) const override { cloud_.write_reports(out); }

 private:
  MemoryNetwork network_;
  std::unique_ptr<Channel> robot_end_;
  std::shared_ptr<const LaserMap> map_;
  SimulatedLocalizers cloud_;
  CloudClient client_;
  SimulatedClient localizer_;
};

class IcpBaseline final : public Localization {
 public:
  IcpBaseline(const ReplayOptions& options, const ReplayConfig& config)
      : localizer_(std::make_shared<const LaserMap>(load_map(*options.map)),
                   config.icp,
                   from_seconds(config.durations.localization_s)) {}

  MapLocalizer& localizer() override { return localizer_; }

 private:
  IcpLocalizer localizer_;
};

/// The same, for the first applied answer only.
class AlignedOnce final : public Localization {
 public:
  explicit AlignedOnce(std::unique_ptr<Localization> localization)
      : localization_(std::move(localization)), localizer_(localization_->localizer()) {}

  MapLocalizer& localizer() override { return localizer_; }
  void finish(const std::filesystem::path& out) const override { localization_->finish(out); }

 private:
  std::unique_ptr<Localization> localization_;
  AlignOnce localizer_;
};

std::unique_ptr<Localization> localization(const ReplayOptions& options,
                                           const ReplayConfig& config) {
  if (!options.map) return nullptr;
  std::unique_ptr<Localization> made;
  if (options.icp_baseline) {
    made = std::make_unique<IcpBaseline>(options, config);
  } else {
    made = std::make_unique<Cloud>(options, config);
  }
  return options.align_once ? std::make_unique<AlignedOnce>(std::move(made)) : std::move(made);
}

/// Writes the cloud's sessions.json at the end of the run, and takes that of an earlier one away.
class SessionsFile final : public RobotSink {
 public:
  SessionsFile(const Localization* localization, std::filesystem::path folder)
      : localization_(localization), folder_(std::move(folder)) {
    std::filesystem::remove(folder_ / "sessions.json");
  }

  void add(const RobotOutput& /*output*/) override {}
  void finish(const RunEnd& /*end*/) override {
    if (localization_ != nullptr) localization_->finish(folder_);
  }

 private:
  const Localization* localization_;
  std::filesystem::path folder_;
};

FaultInjector with_faults(std::unique_ptr<DatasetReader> recording, const FaultPlan& plan) {
  const Timestamp start = recording->recording_start();
  return {std::move(recording), start, plan};
}

/// One replay: what is plugged into the robot's runtime.
class Replay {
 public:
  Replay(const ReplayOptions& options, const ReplayConfig& config)
      : Replay(
            options,
            config,
            std::make_unique<DatasetReader>(DatasetReader::Options{.folder = options.dataset,
                                                                   .start_s = options.start_s,
                                                                   .duration_s = options.duration_s,
                                                                   .tracks = options.tracks})) {}

  void run(const std::stop_token& stop) { runtime_.run(stop); }

 private:
  Replay(const ReplayOptions& options,
         const ReplayConfig& config,
         std::unique_ptr<DatasetReader> recording)
      : localization_(localization(options, config)),
        back_end_(KeyframeWorker(rectified(recording->calibration()),
                                 recording->imu_noise(),
                                 config.worker,
                                 thread_cpu_time),
                  from_seconds(config.durations.back_end_s)),
        robot_({.id = kRobot,
                .calibration = recording->calibration(),
                .imu_noise = recording->imu_noise(),
                .T_map_body = options.T_map_body,
                .region = options.region},
               config.pipeline,
               back_end_,
               localization_ ? &localization_->localizer() : nullptr,
               thread_cpu_time),
        recorder_(options.out),
        sensors_(with_faults(std::move(recording), options.faults)),
        sessions_(localization_.get(), options.out),
        runtime_("frames", sensors_, robot_, {recorder_, sessions_}) {
    recorder_.write_config(options.config);
  }

  std::unique_ptr<Localization> localization_;
  SimulatedBackEnd back_end_;
  RobotPipeline robot_;
  RunRecorder recorder_;
  FaultInjector sensors_;
  SessionsFile sessions_;
  RobotRuntime runtime_;
};

}  // namespace

std::function<void(const std::stop_token&)> prepared_replay(const ReplayOptions& options,
                                                            const ReplayConfig& config) {
  return [replay = std::make_shared<Replay>(options, config)](const std::stop_token& stop) {
    replay->run(stop);
  };
}

}  // namespace fleetloc
