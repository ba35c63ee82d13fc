#include "cloud/laser_map/map_file.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto parts = input_parts(data, size, 2);
  input_file("map.yaml", parts[0]);
  const auto file = input_file("map.pcd", parts[1]);
  read_or_refuse<MapFileError>([&] { load_map(file); });
  return 0;
}
