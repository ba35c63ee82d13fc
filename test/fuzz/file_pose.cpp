#include <cmath>
#include <stdexcept>

#include "shared/geometry/pose_text.hpp"
#include "test/fuzz/target.hpp"

/// Of an option, and of the file of a robot's last pose.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  const std::string text(data, data + size);
  read_or_refuse<std::invalid_argument>([&] {
    const Pose pose = pose_from_text(text);
    require(pose.p.allFinite(), "a position is finite");
    require(std::abs(pose.R.norm() - 1.0) < 1e-9, "a rotation is one");
  });
  return 0;
}
