#include "shared/ros2/camera_info_codec.hpp"
#include "test/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  expect_exact(decode_camera_info({data, size}), decode_camera_info);
  return 0;
}
