#include "deploy/config/default_config.hpp"
#include "test/fuzz/seeds.hpp"

namespace fleetloc {
namespace {

const std::filesystem::path kRoot = FLEETLOC_SOURCE_DIR;

constexpr const char* kChain = R"(cam0:
  T_cam_imu: [[0, -1, 0, 0.01], [0, 0, -1, 0.02], [1, 0, 0, 0.03], [0, 0, 0, 1]]
  camera_model: pinhole
  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002]
  distortion_model: equidistant
  intrinsics: [190.9, 191.4, 254.9, 256.8]
  resolution: [512, 512]
  timeshift_cam_imu: 0.0081
cam1:
  T_cam_imu: [[0, -1, 0, -0.09], [0, 0, -1, 0.02], [1, 0, 0, 0.03], [0, 0, 0, 1]]
  T_cn_cnm1: [[1, 0, 0, -0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00001]
  distortion_model: radtan
  intrinsics: [191.9, 192.4, 253.9, 255.8]
  resolution: [640, 480]
  timeshift_cam_imu: 0.0083
)";

constexpr const char* kImu =
    "update_rate: 200.0\naccelerometer_noise_density: 0.0028\naccelerometer_random_walk: 0.0009\n"
    "gyroscope_noise_density: 0.00016\ngyroscope_random_walk: 0.00002\n"
    "imu_model: {T_i_b: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}\n";

constexpr const char* kSensors =
    "domain: 3\nleft: {name: /left/image_raw, transport: compressed}\n"
    "right: {name: /right/image_raw, qos: default}\nimu: {name: /imu}\n"
    "calibration: {euroc: {folder: mav0}}\n";

constexpr const char* kLink =
    "seed: 1\nuplink: {loss: 0.01, delay_s: 0.03, jitter_s: 0.02, reordering: 0.02, "
    "reordering_delay_s: 0.1, rate_bytes_per_s: 0, queue_bytes: 64000, "
    "rate_trace: [[0, 60000], [10, 0]], rate_trace_repeat_s: 60, outages: [[95, 10]]}\n"
    "downlink: {loss: 0.5, burst_length: 4, duplication: 0.1, delay_s: 2, rate_bytes_per_s: 4000, "
    "queue_bytes: 8000, rate_trace_file: trace.csv, "
    "periodic_outage: {every_s: 60, from_s: 5, for_s: 2}}\n";

constexpr const char* kPlan = R"(title: small
mode: replay
start_error: {position_m: 0.2, yaw_deg: 2}
maps:
  room: {file: room.pcd}
  surveyed: {surveys: {summer: {scene: world.yaml, route: route.yaml, season: summer}}}
datasets:
  flight: {folder: flight, ground_truth: truth.csv, map: room}
  drive:
    map: surveyed
    starts: {count: 2, seed: 1, from_s: 1, to_s: 9}
    simulated: {scene: world.yaml, route: route.yaml, season: summer, duration_s: 20, tracks: true}
  away:
    map: surveyed
    carried: {count: 2, seed: 1, start_s: [3, 9], after_s: [3, 5], for_s: [1, 2], then_s: 5, reset: true}
    simulated: {scene: world.yaml, route: route.yaml, season: summer}
configurations:
  default: {localizers: {events: [{at_s: 0, localizer: a, event: start}]}}
  short: {config: {localizer: {window: 10}}}
  alone: {odometry_only: true}
links:
  ideal: {}
  poor: {loss: 0.5, bandwidth_bytes_per_s: 1000, down: {latency_s: 2}}
  file: {file: link.yaml}
seeds: [1, 2]
)";

void add_files(const SeedFolder& seeds,
               const std::string& target,
               const std::string& folder,
               std::initializer_list<const char*> files) {
  for (const char* file : files) {
    seeds.add(target, file, content_of(kRoot / folder / (std::string(file) + ".yaml")));
  }
}

}  // namespace

void add_config_seeds(const SeedFolder& seeds) {
  for (const char* name : {"robot", "cloud", "map", "replay", "eval", "sim"}) {
    seeds.add("file_config", name, default_config(name));
  }
  seeds.add("file_config", "short", "localizer: {window: 10}\nvio: {window: {merge: false}}\n");
  add_files(seeds, "file_config", "deploy/config", {"paper"});
  add_files(seeds, "file_sensors", "deploy/config", {"sensors-play", "sensors-realsense"});
  seeds.add("file_sensors", "short", kSensors);
  add_files(seeds, "file_world", "deploy/worlds", {"campus", "facades", "garage"});
  add_files(seeds, "file_route", "deploy/worlds", {"loop", "quad-reversed"});
  seeds.add("file_kalibr", "two_cameras", joined({kChain, kImu}));
  seeds.add("file_link", "both_directions", joined({kLink, "# s, bytes/s\n0, 5000\n4, 100\n"}));
  seeds.add("file_faults",
            "several",
            "seed: 7\nfaults:\n  - {kind: black_images, start_s: 1, duration_s: 2}\n"
            "  - {kind: dropped_frames, start_s: 2, duration_s: 3, share: 0.5}\n"
            "  - {kind: clock_step, start_s: 4, step_s: -10}\n");
  seeds.add(
      "file_localizers",
      "two",
      "events:\n  - {at_s: 0, localizer: a, event: start}\n"
      "  - {at_s: 5, localizer: b, event: start}\n  - {at_s: 9, localizer: a, event: kill}\n");
  seeds.add("file_plan",
            "small",
            joined({kPlan,
                    content_of(kRoot / "deploy/worlds/demo/link.yaml"),
                    "seasons: {summer: {}}\n",
                    content_of(kRoot / "deploy/worlds/loop.yaml")}));
}

}  // namespace fleetloc
