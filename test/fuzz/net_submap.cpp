#include "shared/wire/submap_codec.hpp"
#include "test/fuzz/round_trip.hpp"
#include "test/fuzz/usable_submap.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto submap = decode_submap({data, size});
  if (submap) expect_usable(*submap);
  expect_decodable(submap, [](const Bytes& bytes) { return decode_submap(bytes); });
  return 0;
}
