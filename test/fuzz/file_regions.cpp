#include "cloud/laser_map/map_regions.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  input_file("map.regions.yaml", data, size);
  read_or_refuse<ConfigError>([] { load_map_regions(test_folder() / "map.pcd"); });
  return 0;
}
