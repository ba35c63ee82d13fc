#include "shared/transport/instance_key.hpp"
#include "test/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto key = key_of({data, size});
  if (!key) return 0;
  require(key->size() <= 32, "a key has its bound");
  require(instance_of(*key).isDefined(), "a key has an instance");
  return 0;
}
