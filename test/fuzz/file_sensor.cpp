#include "shared/dataset/dataset_error.hpp"
#include "shared/dataset/sensor_file.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto file = input_file("sensor.yaml", data, size);
  read_or_refuse<DatasetError>([&] { read_camera_file(file); });
  read_or_refuse<DatasetError>([&] { read_imu_file(file); });
  read_or_refuse<DatasetError>([&] { read_lidar_file(file); });
  return 0;
}
