#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shared/core/arrival_time.hpp"
#include "shared/core/expected.hpp"
#include "shared/core/time.hpp"
#include "shared/model/stereo_frame.hpp"

namespace fleetloc {

enum class Side : std::size_t { kLeft, kRight };

/// One image of a live camera; an empty one takes the place of an image that cannot be used.
struct LiveImage {
  Timestamp stamp;
  cv::Mat gray;
  ArrivalTime arrival;
  Duration decoding_cpu{};
};

/// Pairs the images of two cameras by stamp: each with the nearest one of those that wait. An image
/// whose partner does not come goes on alone: after `max_wait`, or at once when the other camera
/// has sent a later one, since each camera's messages come in order.
class ImagePairing {
 public:
  /// @param tolerance  largest difference of two stamps, below half the interval of frames
  ImagePairing(Duration tolerance, Duration max_wait)
      : tolerance_(tolerance), max_wait_(max_wait) {}

  /// Stamps of each side increase, unless clear() is called.
  /// @return false if a frame of that time has gone out already
  bool add(Side side, LiveImage image);

  /// The frames that are complete by now, in the order of their stamps: that of the left image if
  /// there is one.
  std::vector<StereoFrame> take(ArrivalTime now);

  /// Forgets what waits, and what has gone out.
  /// @return images that are lost
  std::uint64_t clear();

  /// Images that had to make room for newer ones.
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
  [[nodiscard]] std::size_t waiting() const { return waiting_[0].size() + waiting_[1].size(); }

 private:
  [[nodiscard]] std::deque<LiveImage>& of(Side side) {
    return waiting_[static_cast<std::size_t>(side)];
  }
  [[nodiscard]] std::optional<StereoFrame> next(ArrivalTime now);
  [[nodiscard]] std::optional<StereoFrame> next_of_both();
  StereoFrame take_alone(Side side);
  StereoFrame take_pair();

  Duration tolerance_;
  Duration max_wait_;
  std::array<std::deque<LiveImage>, 2> waiting_;
  std::optional<Timestamp> given_;  // the latest stamp that has gone out
  std::uint64_t dropped_ = 0;
};

}  // namespace fleetloc
