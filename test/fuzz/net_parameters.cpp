#include "shared/transport/workarounds/parameter_check.hpp"
#include "test/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  for (const bool is_little_endian : {false, true}) {
    const bool is_ours =
        is_parameter_list({data, size}, is_little_endian, ParameterSender::kFastDds);
    const bool is_any =
        is_parameter_list({data, size}, is_little_endian, ParameterSender::kAnybody);
    require(is_any || !is_ours, "what is taken of ours is taken of all");
    is_handshake_message({data, size}, is_little_endian);
  }
  return 0;
}
