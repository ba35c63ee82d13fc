#pragma once

#include <string>

namespace fleetloc {

/// What the program `gnuplot` writes to stdout when it is given `script`. Throws std::runtime_error
/// if the program is missing, or rejects the script; then with its message.
std::string gnuplot_output(const std::string& script);

}  // namespace fleetloc
