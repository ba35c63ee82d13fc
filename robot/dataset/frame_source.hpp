#pragma once

#include <cstddef>
#include <vector>

#include "shared/model/camera_frame.hpp"

namespace fleetloc {

/// The frames of a recording, in the order of time; each is read when it is asked for, never ahead.
class FrameSource {
 public:
  FrameSource() = default;
  virtual ~FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  /// Of all frames, increasing.
  [[nodiscard]] virtual const std::vector<Timestamp>& stamps() const = 0;

  /// @param index  of `stamps`, greater than in the call before
  virtual CameraFrame read(std::size_t index) = 0;
};

}  // namespace fleetloc
