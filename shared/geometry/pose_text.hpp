#pragma once

#include <string>

#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// Reads "x y z qx qy qz qw" [m]; the quaternion is normalized. Throws std::invalid_argument that
/// says what is wrong with the text.
Pose pose_from_text(const std::string& text);

/// The same format, with 9 decimals.
std::string pose_text(const Pose& T);

}  // namespace fleetloc
