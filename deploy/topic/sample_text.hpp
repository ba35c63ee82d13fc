#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace fleetloc {

/// As YAML: objects in lines, arrays of numbers in one line each. Ends with a newline.
std::string sample_text(const nlohmann::ordered_json& sample);

}  // namespace fleetloc
