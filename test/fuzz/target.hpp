#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <span>
#include <string_view>

// A target is one function, which gets bytes of any kind. That it returns is all that is asked of
// the decoder: what ends the program is a finding.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace fleetloc {

/// Ends the program unless that holds.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

/// Calls `read`, which may refuse with one of these exceptions; any other one ends the program.
template <typename... Refusals, typename Read>
void read_or_refuse(const Read& read) {
  try {
    read();
  } catch (const std::exception& error) {
    const bool is_refusal = (... || (dynamic_cast<const Refusals*>(&error) != nullptr));
    if (!is_refusal) throw;
    require(!std::string_view(error.what()).empty(), "a refusal says why");
  }
}

}  // namespace fleetloc
