#include "shared/wire/status_codec.hpp"
#include "test/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  expect_exact(decode_robot_status({data, size}), decode_robot_status);
  return 0;
}
