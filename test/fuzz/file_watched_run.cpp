#include "deploy/monitor/watched_run.hpp"
#include "test/fuzz/input_files.hpp"

/// Poses and diagnostics while a robot writes them: as far as a part of them, then all. The same as
/// those of a localizer.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto parts = input_parts(data, size, 2);
  const Trajectory truth{{.stamp = Timestamp(Duration(0)), .T_ref_body = {}},
                         {.stamp = Timestamp(Duration(100)), .T_ref_body = {}}};
  input_file("localization_frames.tum", parts[0].substr(0, parts[0].size() / 2));
  input_file("diagnostics.csv", parts[1].substr(0, parts[1].size() / 2));
  WatchedRun run(test_folder(), truth);
  run.update();
  input_file("localization_frames.tum", parts[0]);
  input_file("diagnostics.csv", parts[1]);
  run.update();
  input_file("status.csv", parts[1]);
  WatchedLocalizer(test_folder()).update();
  return 0;
}
