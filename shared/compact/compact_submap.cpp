#include "shared/compact/compact_submap.hpp"

#include <algorithm>
#include <cmath>

namespace fleetloc {
namespace {

constexpr double kLargestSigma = 16.0;

}  // namespace

std::vector<StrictPose> poses_of(const CompactSubmap& submap) {
  std::vector<StrictPose> poses(submap.keyframes.size());
  StrictRotation q = submap.newest_rotation;
  for (std::size_t i = submap.keyframes.size(); i-- > 0;) {
    const CompactSubmap::Keyframe& keyframe = submap.keyframes[i];
    if (i + 1 < submap.keyframes.size())
      q = normalized(product(q, rotation_of(keyframe.turn, CompactSubmap::kUnitsPerQuaternion)));
    poses[i].R = matrix_of(q);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      poses[i].p[axis] = keyframe.position[axis] * CompactSubmap::kMetresPerUnit;
    }
  }
  return poses;
}

double SigmaCode::sigma(int code) {
  constexpr std::array kQuarterOctaves{
      1.0, 0.84089641525371454, 0.70710678118654752, 0.59460355750136053};
  const int step = code - 1;
  return std::ldexp(kLargestSigma * kQuarterOctaves[static_cast<std::size_t>(step % 4)],
                    -(step / 4));
}

int SigmaCode::nearest(double sigma) {
  if (!(sigma > 0.0)) return kMax;
  return 1 + static_cast<int>(
                 std::lround(std::clamp(-4.0 * std::log2(sigma / kLargestSigma), 0.0, kMax - 1.0)));
}

}  // namespace fleetloc
