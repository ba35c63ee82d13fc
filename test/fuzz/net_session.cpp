#include "shared/wire/session_codec.hpp"
#include "test/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  expect_decodable(decode_robot_session({data, size}), decode_robot_session);
  return 0;
}
