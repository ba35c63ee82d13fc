#include "shared/geometry/pose_text.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <stdexcept>

namespace fleetloc {

Pose pose_from_text(const std::string& text) {
  std::istringstream stream(text);
  std::array<double, 7> values{};
  for (double& value : values) {
    if (!(stream >> value) || !std::isfinite(value)) {
      throw std::invalid_argument("'" + text + "' is no pose: expected \"x y z qx qy qz qw\"");
    }
  }
  std::string rest;
  if (stream >> rest) {
    throw std::invalid_argument("'" + text + "' is no pose: more than seven numbers");
  }
  const Eigen::Quaterniond R(values[6], values[3], values[4], values[5]);
  if (R.norm() < 1e-6) throw std::invalid_argument("'" + text + "' is no pose: zero quaternion");
  if (!std::isfinite(R.norm())) {
    throw std::invalid_argument("'" + text + "' is no pose: the quaternion is too long");
  }
  return {R.normalized(), {values[0], values[1], values[2]}};
}

std::string pose_text(const Pose& T) {
  std::array<char, 256> text{};
  std::snprintf(text.data(),
                text.size(),
                "%.9f %.9f %.9f %.9f %.9f %.9f %.9f",
                T.p.x(),
                T.p.y(),
                T.p.z(),
                T.R.x(),
                T.R.y(),
                T.R.z(),
                T.R.w());
  return text.data();
}

}  // namespace fleetloc
