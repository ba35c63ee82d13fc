#include <sstream>

#include "cloud/mapping/lidar_file.hpp"
#include "shared/dataset/sensor_file.hpp"
#include "shared/geometry/pose_text.hpp"
#include "shared/trajectory/tum_file.hpp"
#include "test/fuzz/seeds.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

std::string poses() {
  std::ostringstream text;
  for (const int i : {0, 1, 2}) {
    write_tum_line(text, Timestamp(Duration(1'403'636'579'000'000'000 + 50'000'000 * i)), {});
  }
  return text.str();
}

/// Two frames, as RunFolder writes them.
std::string diagnostics() {
  std::string header = "stamp_s,state,since_last_answer_s";
  std::string values;
  for (const char* prefix : {"cm", "co"}) {
    for (int row = 1; row <= 6; ++row) {
      for (int column = row; column <= 6; ++column) {
        header += "," + std::string(prefix) + std::to_string(row) + std::to_string(column);
        values += row == column ? ",1e-3" : ",0";
      }
    }
  }
  const std::string unknown = [] {
    std::string nans;
    for (int i = 0; i < 42; ++i) nans += ",nan";
    return nans;
  }();
  return header +
         ",uplink_bytes,downlink_bytes,loss,round_trip_s,tracks,keyframe,resets\n"
         "1403636579.000000000,initializing,0.0" +
         unknown + ",0,0,0.25,nan,100,1,0\n1403636579.050000000,localized,0.5" + values +
         ",900,300,0.1000,0.050000,120,0,0\n";
}

void add_sensors(const SeedFolder& seeds) {
  const CameraFile camera{.camera = {.width_px = 752,
                                     .height_px = 480,
                                     .focal_px = {458.0, 457.0},
                                     .center_px = {367.0, 248.0}},
                          .T_rig_cam = {},
                          .rate_hz = 20.0};
  const ImuNoise noise{.gyroscope_noise_density = 1e-4,
                       .gyroscope_random_walk = 1e-5,
                       .accelerometer_noise_density = 1e-3,
                       .accelerometer_random_walk = 1e-4};
  seeds.add("file_sensor", "camera", "%YAML:1.0\n" + camera_file_text(camera));
  seeds.add(
      "file_sensor", "imu", imu_file_text({.noise = noise, .T_rig_imu = {}, .rate_hz = 200.0}));
  seeds.add("file_sensor",
            "lidar",
            lidar_file_text({.T_body_lidar = {}, .rate_hz = 10.0, .columns = 1024, .rings = 16}));
}

void add_scan(const SeedFolder& seeds) {
  const auto folder = test_folder() / "lidar0";
  LidarWriter writer(folder, {.T_body_lidar = {}, .rate_hz = 10.0, .columns = 1024, .rings = 16});
  writer.add({.stamp = Timestamp(Duration(1)),
              .points = {{.p_lidar = {1.0F, 2.0F, 3.0F}, .column = 7, .ring = 2},
                         {.p_lidar = {-1.0F, 0.5F, 9.0F}, .column = 1023, .ring = 15}}});
  writer.finish();
  seeds.add("file_scan",
            "two_points",
            joined({content_of(folder / "data.csv"), content_of(folder / "data/1.bin")}));
}

}  // namespace

void add_recording_seeds(const SeedFolder& seeds) {
  add_sensors(seeds);
  add_scan(seeds);
  seeds.add("file_recording",
            "two_frames",
            joined({"#timestamp [ns],w,w,w,a,a,a\n0,0,0,0,0,0,9.81\n5000000,0.1,0,0,0,0,9.81\n"
                    "60000000,0,0,-2e-1,0,0,9.81\n120000000,0,0,0,0,0,9.81\n",
                    "#timestamp [ns],observations\n10000000,2\n60000000,1\n110000000,1\n",
                    "#landmark,u,v,disparity\n1,10.5,20,0\n7,600,400.25,3.5\n7,1,2,3\n9,4,5,6\n"}));
  seeds.add("file_image_list",
            "pairs",
            joined({"#timestamp [ns],filename\n10,1.png\n50000000,2.png\n", "20,1.png\n"}));
  seeds.add("file_trajectory", "tum", poses());
  seeds.add("file_trajectory",
            "euroc",
            "#timestamp,x,y,z,w,x,y,z\n1403636579,1,2,3,1,0,0,0,0,0,0,0,0,0,0,0,0\n"
            "1403636580,1,2,3,0.6,0,0.8,0\n");
  seeds.add("file_pose", "some", pose_text({Eigen::Quaterniond(0.6, 0.0, 0.8, 0.0), {1, 2, 3}}));
  seeds.add("file_diagnostics", "two_frames", diagnostics());
  const std::string answers =
      "stamp_s,arrival_s,localizer,status,reason,applied,innovation_m,innovation_deg,places\n"
      "1403636579.000000000,1403636579.030000000,cloud,localized,,1,0.1,0.2,0\n";
  seeds.add(
      "file_run",
      "two_frames",
      joined({"{\"coverage\": 0.5, \"robot\": {\"frames\": 3}}", answers, poses(), diagnostics()}));
  seeds.add("file_watched_run", "two_frames", joined({poses(), diagnostics()}));
  seeds.add("file_watched_run",
            "localizer",
            joined({"", "stamp_s,state,sessions,load,submaps,localized\n1,accepting,2,0.5,9,8\n"}));
}

}  // namespace fleetloc
