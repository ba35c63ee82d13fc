#include "deploy/sim/recording/sim_run.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>
#include <vector>

#include "cloud/mapping/lidar_file.hpp"
#include "cloud/point_cloud/point_cloud_file.hpp"
#include "cloud/point_cloud/voxel_cloud.hpp"
#include "deploy/sim/recording/sim_tracks.hpp"
#include "shared/concurrency/parallel_rows.hpp"
#include "shared/config/progress_line.hpp"
#include "shared/dataset/sensor_file.hpp"

namespace fleetloc {
namespace {

constexpr double kSlack = 1e-9;

/// What is simulated, and how; all of it outlives the job.
struct Job {
  const SimMotion& motion;
  const SeasonScene& scene;
  const SimConfig& config;
  const SimOptions& options;
  const std::stop_token& stop;
};

DatasetWriter::Options writer_options(const SimConfig& config, const SimOptions& options) {
  return {.folder = options.out,
          .calibration = config.cameras,
          .imu_noise = config.imu.noise,
          .frame_rate_hz = config.frame_rate_hz,
          .imu_rate_hz = config.imu.rate_hz,
          .format = config.format,
          .jpeg_quality = std::max(1, config.jpeg_quality)};
}

/// The times of a sensor that are within the part of the motion.
struct Ticks {
  std::uint64_t first = 0;
  std::uint64_t end = 0;
};

Ticks ticks(double rate_hz, const SimOptions& options) {
  const double first = std::max(0.0, std::ceil(options.begin_s * rate_hz - kSlack));
  const double last = std::floor(options.end_s * rate_hz + kSlack);
  return {.first = static_cast<std::uint64_t>(first), .end = static_cast<std::uint64_t>(last) + 1};
}

/// The IMU from a second before the first image on, to initialize the odometry.
void write_imu(const ImuRecord& record,
               const SimMotion& motion,
               const SimOptions& options,
               DatasetWriter& writer) {
  constexpr double kBefore = 1.0;  // [s]
  for (const ImuSample& sample : record.samples) {
    const double time_s = to_seconds(sample.stamp - motion.start);
    if (time_s < options.begin_s - kBefore - kSlack || time_s > options.end_s + kSlack) continue;
    writer.add(sample);
  }
}

/// Of a recorded IMU the biases are not known, and stay zero.
void write_ground_truth(const ImuRecord& record,
                        const SimMotion& motion,
                        const SimConfig& config,
                        const SimOptions& options,
                        DatasetWriter& writer) {
  const Ticks lines = ticks(config.ground_truth_hz, options);
  for (std::uint64_t i = lines.first; i < lines.end; ++i) {
    const Duration after_start = from_seconds(static_cast<double>(i) / config.ground_truth_hz);
    const double time_s = to_seconds(after_start);
    const MotionState state = motion.motion.at(time_s);
    NavState line{.T_odom_body = state.T_map_body, .v_odom = state.v_map, .bias = {}};
    if (!record.biases.empty()) {
      const auto sample = static_cast<std::size_t>(time_s * config.imu.rate_hz + kSlack);
      line.bias = record.biases[std::min(sample, record.biases.size() - 1)];
    }
    writer.add_ground_truth(motion.start + after_start, line);
  }
}

std::size_t write_images(const Job& job, DatasetWriter& writer) {
  const SimMotion& motion = job.motion;
  const SimConfig& config = job.config;
  const SimOptions& options = job.options;
  StereoRenderer::Config settings = config.renderer;
  settings.threads = options.threads;
  StereoRenderer renderer(config.cameras, job.scene, settings, options.seed);
  ProgressLine progress("stereo pairs");
  const Ticks frames = ticks(config.frame_rate_hz, options);
  std::size_t done = 0;
  for (std::uint64_t i = frames.first; i < frames.end && !job.stop.stop_requested(); ++i) {
    const Duration after_start = from_seconds(static_cast<double>(i) / config.frame_rate_hz);
    writer.add(renderer.render(
        {.stamp = motion.start + after_start, .time_s = to_seconds(after_start), .frame = i},
        [&motion](double time_s) { return motion.motion.at(time_s).T_map_body; }));
    progress.show(++done, frames.end - frames.first);
  }
  return done;
}

/// Adds a scan to a cloud in map, each point from the pose of its own time.
void merge(const LidarScan& scan,
           const SimMotion& motion,
           const LidarCalibration& lidar,
           double max_range_m,
           VoxelCloud& cloud) {
  const double begin_s = to_seconds(scan.stamp - motion.start);
  int column = -1;
  Pose T_map_lidar;
  for (const LidarPoint& point : scan.points) {
    if (static_cast<double>(point.p_lidar.norm()) > max_range_m) continue;
    if (point.column != column) {
      column = point.column;
      const double time_s = begin_s + lidar.column_time_s(column);
      T_map_lidar = motion.motion.at(time_s).T_map_body * lidar.T_body_lidar;
    }
    cloud.add(T_map_lidar * point.p_lidar.cast<double>());
  }
}

std::size_t write_scans(const Job& job, VoxelCloud& cloud) {
  const SimMotion& motion = job.motion;
  const SimConfig& config = job.config;
  const SimOptions& options = job.options;
  const Lidar lidar(config.lidar, options.seed);
  const LidarCalibration& calibration = config.lidar.calibration;
  LidarWriter writer(options.out / "mav0" / "lidar0", calibration);
  ProgressLine progress("lidar scans");
  Ticks all = ticks(calibration.rate_hz, options);
  if (all.end > all.first) --all.end;  // a scan that is begun is ended
  const int block = 4 * options.threads;
  std::vector<LidarScan> scans(static_cast<std::size_t>(block));
  std::size_t done = 0;
  for (std::uint64_t first = all.first; first < all.end && !job.stop.stop_requested();
       first += scans.size()) {
    const int count = static_cast<int>(std::min<std::uint64_t>(scans.size(), all.end - first));
    for_each_row(count, options.threads, [&](int i) {
      const std::uint64_t index = first + static_cast<std::uint64_t>(i);
      const double middle_s = lidar.scan_time_s(index) + 0.5 / calibration.rate_hz;
      scans[static_cast<std::size_t>(i)] =
          lidar.scan(job.scene.at(middle_s).caster, motion.motion, motion.start, index);
    });
    for (int i = 0; i < count; ++i) {
      const LidarScan& scan = scans[static_cast<std::size_t>(i)];
      writer.add(scan);
      if (options.merged_cloud) {
        merge(scan, motion, calibration, config.merged_cloud.max_range_m, cloud);
      }
      progress.show(++done, all.end - all.first);
    }
  }
  writer.finish();
  return done;
}

/// Byte for byte, and what belongs to it.
void copy_imu(const std::filesystem::path& file, const std::filesystem::path& out) {
  const auto folder = out / "mav0" / "imu0";
  constexpr auto kReplace = std::filesystem::copy_options::overwrite_existing;
  std::error_code error;
  std::filesystem::copy_file(file, folder / "data.csv", kReplace, error);
  const auto sensor = file.parent_path() / "sensor.yaml";
  if (!error && std::filesystem::is_regular_file(sensor)) {
    std::filesystem::copy_file(sensor, folder / "sensor.yaml", kReplace, error);
  }
  if (error) throw DatasetError(file.string() + ": cannot be copied: " + error.message());
}

}  // namespace

SimCounts simulate(const SimMotion& motion,
                   const SeasonScene& scene,
                   const SimConfig& config,
                   const SimOptions& options,
                   const std::stop_token& stop) {
  const Job job{
      .motion = motion, .scene = scene, .config = config, .options = options, .stop = stop};
  DatasetWriter writer(writer_options(config, options));
  ImuRecord imu;
  if (options.recorded_imu.empty()) {
    imu = measured_imu(motion.motion, config.imu, motion.start, options.seed);
    write_imu(imu, motion, options, writer);
  }
  write_ground_truth(imu, motion, config, options, writer);
  SimCounts counts;
  if (options.images) {
    counts.frames = write_images(job, writer);
  }
  if (options.tracks) {
    const Ticks frames = ticks(config.frame_rate_hz, options);
    counts.frames =
        write_tracks({.motion = &motion, .scene = &scene, .first = frames.first, .end = frames.end},
                     config,
                     options.seed,
                     options.out / "mav0" / "tracks0",
                     stop);
  }
  writer.finish();
  if (!options.recorded_imu.empty()) copy_imu(options.recorded_imu, options.out);
  if (options.lidar) {
    VoxelCloud cloud(config.merged_cloud.voxel_m, config.merged_cloud.max_points);
    counts.scans = write_scans(job, cloud);
    if (options.merged_cloud) {
      const auto folder = options.out / "mav0" / "pointcloud0";
      std::filesystem::create_directories(folder);
      write_ply(folder / "data.ply", cloud.points());
      counts.merged_points = cloud.size();
      counts.merged_voxel_m = cloud.edge_m();
    }
  }
  return counts;
}

void expect_no_dataset(const std::filesystem::path& out) {
  if (std::filesystem::exists(out / "mav0")) {
    throw DatasetError((out / "mav0").string() + ": there is a dataset already");
  }
}

}  // namespace fleetloc
