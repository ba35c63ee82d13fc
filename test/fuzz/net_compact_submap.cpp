#include <array>

#include "shared/compact/submap_sample.hpp"
#include "test/fuzz/usable_submap.hpp"

namespace fleetloc {
namespace {

/// Of the smallest and the largest numbers that a session may have, and usual ones.
RectifiedStereo stereo_of(std::uint8_t choice) {
  constexpr std::array<double, 3> kFocal{458.0, 1.0, 1e5};
  constexpr std::array<double, 3> kBaseline{0.11, 0.0, 100.0};
  constexpr std::array<double, 3> kCenter{1024.0, 0.0, kRectifiedSize};
  const double center = kCenter[choice / 9 % 3];
  return {.focal_px = kFocal[choice % 3],
          .center_px = {center, center},
          .baseline_m = kBaseline[choice / 3 % 3],
          .T_body_cam0 = {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.05, 0.02, -0.01}}};
}

}  // namespace
}  // namespace fleetloc

/// The first byte chooses the calibration of the session, the sample follows.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace fleetloc;
  if (size == 0) return 0;
  const auto sample = decode_submap_sample({data + 1, size - 1});
  if (!sample) return 0;
  const RectifiedStereo stereo = stereo_of(data[0]);
  const auto submap = decode_submap(*sample, stereo);
  if (submap) expect_usable(*submap);
  return 0;
}
