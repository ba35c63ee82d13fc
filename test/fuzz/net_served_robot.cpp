#include "shared/wire/served_robot_codec.hpp"
#include "test/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  expect_decodable(decode_served_robot({data, size}), decode_served_robot);
  return 0;
}
