#pragma once

#include <variant>

#include "shared/model/observation.hpp"
#include "shared/model/stereo_frame.hpp"

namespace fleetloc {

/// What the cameras gave at one instant: images, or what a front end made of them elsewhere.
using CameraFrame = std::variant<StereoFrame, TrackedFrame>;

inline Timestamp stamp_of(const CameraFrame& frame) {
  return std::visit([](const auto& any) { return any.stamp; }, frame);
}

}  // namespace fleetloc
