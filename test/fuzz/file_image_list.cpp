#include "robot/dataset/stereo_index.hpp"
#include "shared/dataset/dataset_error.hpp"
#include "test/fuzz/small_recording.hpp"

/// The lists of both cameras.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto mav0 = small_recording();
  const auto parts = input_parts(data, size, 2);
  input_file("mav0/cam0/data.csv", parts[0]);
  input_file("mav0/cam1/data.csv", parts[1]);
  read_or_refuse<DatasetError>([&] {
    const auto left = read_image_list(mav0 / "cam0");
    pair_images(left, read_image_list(mav0 / "cam1"));
  });
  return 0;
}
