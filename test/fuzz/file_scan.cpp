#include "cloud/mapping/lidar_file.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  static const std::string calibration =
      lidar_file_text({.T_body_lidar = {}, .rate_hz = 10.0, .columns = 1024, .rings = 16});
  const auto folder = test_folder() / "lidar0";
  std::filesystem::create_directories(folder / "data");
  const auto parts = input_parts(data, size, 2);
  input_file("lidar0/sensor.yaml", calibration);
  input_file("lidar0/data.csv", parts[0]);
  input_file("lidar0/data/1.bin", parts[1]);
  read_or_refuse<DatasetError>([&] {
    const LidarReader reader(folder);
    for (std::size_t i = 0; i < reader.size(); ++i) static_cast<void>(reader.scan(i));
  });
  return 0;
}
