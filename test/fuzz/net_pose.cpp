#include "shared/wire/pose_codec.hpp"
#include "test/fuzz/round_trip.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  expect_decodable(decode_pose_estimate({data, size}), decode_pose_estimate);
  return 0;
}
