#include "deploy/evaluation/errors/diagnostics_file.hpp"
#include "shared/config/delimited_file.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto file = input_file("diagnostics.csv", data, size);
  read_or_refuse<TextFileError>([&] { read_covariances(file); });
  read_or_refuse<TextFileError>([&] { read_frame_diagnostics(file); });
  return 0;
}
