#include "shared/ros2/image_codec.hpp"
#include "test/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  expect_exact(decode_image({data, size}), decode_image);
  return 0;
}
