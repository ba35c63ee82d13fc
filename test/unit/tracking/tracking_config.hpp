#pragma once

#include "deploy/config/default_config.hpp"
#include "robot/tracking/feature_tracker.hpp"

namespace fleetloc {

inline FeatureTracker::Config default_tracking_config() {
  return read_feature_tracker_config(
      ConfigReader::from_string(default_config("robot")).section("tracking"));
}

}  // namespace fleetloc
