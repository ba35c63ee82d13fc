#pragma once

#include <variant>

#include "shared/model/observation.hpp"
#include "shared/model/stereo_frame.hpp"

namespace fleetloc {

/// One stereo frame: images, or the observations that a front end has made of them.
using CameraFrame = std::variant<StereoFrame, TrackedFrame>;

inline Timestamp stamp_of(const CameraFrame& frame) {
  return std::visit([](const auto& any) { return any.stamp; }, frame);
}

}  // namespace fleetloc
