#pragma once

#include <opencv2/core/mat.hpp>

#include "shared/core/time.hpp"

namespace fleetloc {

/// Two images of one instant, 8 bit gray. An empty image is one that is missing.
struct StereoFrame {
  Timestamp stamp;
  cv::Mat left;
  cv::Mat right;
  Duration decoding_cpu{};  ///< processor time that it took to read the images; only for reports
};

}  // namespace fleetloc
