#include "robot/live/sensors_config.hpp"
#include "shared/config/config_reader.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto file = input_file("sensors.yaml", data, size);
  read_or_refuse<ConfigError>([&] { read_sensors_config(file); });
  return 0;
}
