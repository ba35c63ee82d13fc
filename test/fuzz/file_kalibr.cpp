#include "robot/calibration/kalibr_rig.hpp"
#include "shared/config/config_reader.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto parts = input_parts(data, size, 2);
  const KalibrFiles files{.camchain = input_file("camchain.yaml", parts[0]),
                          .imu = input_file("imu.yaml", parts[1])};
  read_or_refuse<ConfigError>([&] { read_kalibr_rig(files); });
  return 0;
}
