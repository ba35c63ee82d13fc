#pragma once

#include <pcl/console/print.h>

namespace fleetloc {

/// Silences PCL's console output during its lifetime: exceptions and results report what goes
/// wrong.
class QuietPcl {
 public:
  QuietPcl() { pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS); }
  ~QuietPcl() { pcl::console::setVerbosityLevel(before_); }
  QuietPcl(const QuietPcl&) = delete;
  QuietPcl& operator=(const QuietPcl&) = delete;

 private:
  pcl::console::VERBOSITY_LEVEL before_ = pcl::console::getVerbosityLevel();
};

}  // namespace fleetloc
