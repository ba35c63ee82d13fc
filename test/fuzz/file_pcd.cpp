#include "cloud/point_cloud/point_cloud_file.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto file = input_file("cloud.pcd", data, size);
  read_or_refuse<PointCloudError>([&] { read_points(file); });
  return 0;
}
