#include "shared/ros2/image_codec.hpp"
#include "shared/ros2/pixel_encoding.hpp"
#include "test/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const auto image = decode_compressed_image({data, size});
  if (!image) return 0;
  require(image->gray.type() == CV_8UC1, "an image is gray");
  require(image->gray.total() <= kMaxPixels, "an image is not too large");
  return 0;
}
