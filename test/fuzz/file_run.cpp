#include <stdexcept>

#include "deploy/evaluation/report/run_data.hpp"
#include "test/fuzz/input_files.hpp"

/// What a run has written: its summary, its answers, its poses, its diagnostics.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto parts = input_parts(data, size, 4);
  input_file("summary.json", parts[0]);
  input_file("answers.csv", parts[1]);
  input_file("odometry.tum", parts[2]);
  input_file("localization_frames.tum", parts[2]);
  input_file("diagnostics.csv", parts[3]);
  read_or_refuse<std::runtime_error>([] {
    const RunData run = read_run(test_folder());
    errors_of(run, run.localized, std::chrono::milliseconds(150));
  });
  return 0;
}
