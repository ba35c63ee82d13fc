#pragma once

#include <string_view>

namespace fleetloc {

/// experiment.html at build time.
std::string_view experiment_html();

}  // namespace fleetloc
