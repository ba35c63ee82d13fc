#pragma once

#include <string>

namespace fleetloc {

/// What the program `gnuplot` writes to stdout when it is given `script`. Throws std::runtime_error
/// if the program is missing, or does not like the script; then with its own words.
std::string gnuplot_output(const std::string& script);

}  // namespace fleetloc
