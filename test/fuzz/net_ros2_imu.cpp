#include "shared/ros2/imu_codec.hpp"
#include "test/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  expect_exact(decode_imu({data, size}), decode_imu);
  return 0;
}
