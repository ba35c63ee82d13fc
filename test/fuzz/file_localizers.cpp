#include "deploy/replay/localizer_plan.hpp"
#include "shared/config/config_reader.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto file = input_file("localizers.yaml", data, size);
  read_or_refuse<ConfigError>([&] { read_localizer_plan(ConfigReader::from_file(file)); });
  return 0;
}
