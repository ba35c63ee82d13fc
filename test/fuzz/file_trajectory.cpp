#include "shared/trajectory/tum_file.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  for (const char* name : {"poses.tum", "poses.csv"}) {
    const auto file = input_file(name, data, size);
    read_or_refuse<TrajectoryFileError>([&] { read_trajectory(file); });
    read_or_refuse<TrajectoryFileError>([&] { read_poses_in_any_order(file); });
  }
  return 0;
}
