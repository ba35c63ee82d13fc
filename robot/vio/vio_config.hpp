#pragma once

#include "robot/vio/frame_estimator.hpp"
#include "robot/vio/initializer.hpp"
#include "robot/vio/sliding_window.hpp"

namespace fleetloc {

/// Section `vio` of robot.yaml.
struct VioConfig {
  Initializer::Config initializer;
  SlidingWindow::Config window;
  FrameEstimator::Config frame_estimator;
};
VioConfig read_vio_config(ConfigReader section);

}  // namespace fleetloc
