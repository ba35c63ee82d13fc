#include "deploy/replay/replay.hpp"

#include <chrono>
#include <memory>
#include <utility>

#include "cloud/laser_map/map_file.hpp"
#include "cloud/pool/sessions_report.hpp"
#include "deploy/replay/fault_injector.hpp"
#include "deploy/replay/simulated_back_end.hpp"
#include "deploy/replay/simulated_cloud.hpp"
#include "robot/run_folder/run_recorder.hpp"
#include "shared/config/progress_line.hpp"
#include "shared/core/cpu_time.hpp"
#include "shared/link/memory_network.hpp"

namespace fleetloc {
namespace {

constexpr const char* kRobot = "robot";
constexpr const char* kLocalizer = "localizer";

/// The localization back end behind the robot's MapLocalizer, in simulated time.
class LocalizationBackend {
 public:
  LocalizationBackend() = default;
  virtual ~LocalizationBackend() = default;
  LocalizationBackend(const LocalizationBackend&) = delete;
  LocalizationBackend& operator=(const LocalizationBackend&) = delete;

  [[nodiscard]] virtual MapLocalizer& localizer() = 0;
  virtual void advance(const PoseEstimate&) {}
  [[nodiscard]] virtual CloudClient::Traffic traffic() const { return {}; }
  virtual void finish(const std::filesystem::path&) const {}
};

/// Link and cloud.
class Cloud final : public LocalizationBackend {
 public:
  Cloud(const ReplayOptions& options, const ReplayConfig& config)
      : network_(options.link),
        robot_end_(network_.join_robot(kRobot)),
        cloud_end_(network_.join_cloud(kLocalizer)),
        cloud_(LocalizerPool(kLocalizer,
                             Incarnation{1},
                             std::make_shared<const LaserMap>(load_map(*options.map)),
                             config.pool),
               *cloud_end_,
               from_seconds(config.durations.localization_s),
               thread_cpu_time),
        client_(kRobot, *robot_end_, config.client) {}

  MapLocalizer& localizer() override { return client_; }
  void advance(const PoseEstimate& pose) override {
    client_.set_quality(pose.quality);
    cloud_.advance(pose.stamp);
  }
  [[nodiscard]] CloudClient::Traffic traffic() const override { return client_.traffic(); }
  void finish(const std::filesystem::path& out) const override {
    write_sessions(out / "sessions.json", cloud_.pool().reports());
  }

 private:
  MemoryNetwork network_;
  std::unique_ptr<Channel> robot_end_;
  std::unique_ptr<Channel> cloud_end_;
  SimulatedCloud cloud_;
  CloudClient client_;
};

class IcpBaseline final : public LocalizationBackend {
 public:
  IcpBaseline(const ReplayOptions& options, const ReplayConfig& config)
      : localizer_(std::make_shared<const LaserMap>(load_map(*options.map)),
                   config.icp,
                   from_seconds(config.durations.localization_s)) {}

  MapLocalizer& localizer() override { return localizer_; }

 private:
  IcpLocalizer localizer_;
};

std::unique_ptr<LocalizationBackend> localization_backend(const ReplayOptions& options,
                                                          const ReplayConfig& config) {
  if (!options.map) return nullptr;
  if (options.icp_baseline) return std::make_unique<IcpBaseline>(options, config);
  return std::make_unique<Cloud>(options, config);
}

/// One replay: the parts, and what happens at each item of the dataset.
class Replay {
 public:
  Replay(const ReplayOptions& options, const ReplayConfig& config)
      : input_(DatasetReader({.folder = options.dataset,
                              .start_s = options.start_s,
                              .duration_s = options.duration_s,
                              .tracks = options.tracks}),
               options.faults),
        localization_(localization_backend(options, config)),
        back_end_(KeyframeWorker(rectified(input_.reader().calibration()),
                                 input_.reader().imu_noise(),
                                 config.worker,
                                 thread_cpu_time),
                  from_seconds(config.durations.back_end_s)),
        pipeline_({.id = kRobot,
                   .calibration = input_.reader().calibration(),
                   .imu_noise = input_.reader().imu_noise(),
                   .T_map_body = options.T_map_body,
                   .align_once = options.align_once},
                  config.pipeline,
                  back_end_,
                  localization_ ? &localization_->localizer() : nullptr,
                  thread_cpu_time),
        recorder_(options.out),
        out_(options.out) {
    recorder_.write_config(options.config);
  }

  void run(const std::stop_token& stop);

 private:
  std::optional<DatasetReader::Item> next();
  void take(const ImuSample& sample);
  [[nodiscard]] CloudClient::Traffic traffic() const {
    return localization_ ? localization_->traffic() : CloudClient::Traffic{};
  }

  FaultInjector input_;
  std::unique_ptr<LocalizationBackend> localization_;
  SimulatedBackEnd back_end_;
  RobotPipeline pipeline_;
  RunRecorder recorder_;
  std::filesystem::path out_;
};

std::optional<DatasetReader::Item> Replay::next() {
  const Duration begin = thread_cpu_time();
  auto item = input_.next();
  if (item && std::holds_alternative<CameraFrame>(*item)) {
    recorder_.add_decoding(thread_cpu_time() - begin);
  }
  return item;
}

void Replay::take(const ImuSample& sample) {
  const auto pose = pipeline_.add_imu(sample);
  if (!pose) return;  // refused: neither its content nor its stamp can be trusted
  recorder_.add_imu_rate_pose(*pose);
  if (localization_) localization_->advance(*pose);
  pipeline_.poll(pose->stamp);
  recorder_.record(pipeline_, traffic());
}

void Replay::run(const std::stop_token& stop) {
  const auto begin = std::chrono::steady_clock::now();
  std::size_t frames = 0;
  {
    ProgressLine progress("frames");
    while (!stop.stop_requested()) {
      auto item = next();
      if (!item) break;
      if (const auto* sample = std::get_if<ImuSample>(&*item)) {
        take(*sample);
      } else {
        pipeline_.add_frame(std::get<CameraFrame>(std::move(*item)));
        progress.show(++frames, input_.reader().frame_count());
      }
    }
  }
  recorder_.record(pipeline_, traffic());
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  recorder_.finish(pipeline_,
                   traffic(),
                   {.interrupted = stop.stop_requested(),
                    .wall_s = wall.count(),
                    .input_faults = input_.faults()});
  if (localization_) localization_->finish(out_);
}

}  // namespace

std::function<void(const std::stop_token&)> prepared_replay(const ReplayOptions& options,
                                                            const ReplayConfig& config) {
  return [replay = std::make_shared<Replay>(options, config)](const std::stop_token& stop) {
    replay->run(stop);
  };
}

}  // namespace fleetloc
