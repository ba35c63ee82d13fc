#include "robot/dataset/image_file.hpp"
#include "shared/dataset/dataset_error.hpp"
#include "test/fuzz/input_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto file = input_file("image", data, size);
  read_or_refuse<DatasetError>(
      [&] { require(read_image(file).type() == CV_8UC1, "an image is gray"); });
  return 0;
}
