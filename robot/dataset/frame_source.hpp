#pragma once

#include <cstddef>
#include <vector>

#include "shared/model/camera_frame.hpp"

namespace fleetloc {

/// The frames of a recording, in time order; each is read on demand, never ahead.
class FrameSource {
 public:
  FrameSource() = default;
  virtual ~FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;

  /// Stamps of all frames, increasing.
  [[nodiscard]] virtual const std::vector<Timestamp>& stamps() const = 0;

  /// Throws DatasetError.
  /// @param index  of `stamps`, greater than in the call before
  virtual CameraFrame read(std::size_t index) = 0;
};

}  // namespace fleetloc
