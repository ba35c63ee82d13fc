#include "deploy/sim/motion/motion_config.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto file = input_file("route.yaml", data, size);
  read_or_refuse<ConfigError>([&] { read_route(file); });
  return 0;
}
