#include "robot/dataset/dataset_reader.hpp"
#include "test/fuzz/small_recording.hpp"

/// The samples of the IMU, the list of frames, and their tracks.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto mav0 = small_recording();
  const auto parts = input_parts(data, size, 3);
  input_file("mav0/imu0/data.csv", parts[0]);
  input_file("mav0/tracks0/data.csv", parts[1]);
  input_file("mav0/tracks0/observations.csv", parts[2]);
  read_or_refuse<DatasetError>([&] {
    DatasetReader reader({.folder = mav0, .start_s = 0.01, .duration_s = 1e6, .tracks = true});
    while (reader.next()) {
    }
    reader.close();
  });
  return 0;
}
