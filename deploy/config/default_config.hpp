#pragma once

#include <string_view>

namespace fleetloc {

/// Text of deploy/config/<name>.yaml at build time; "everything" is all of them together, which is
/// what each program starts from. Throws std::out_of_range for an unknown name.
std::string_view default_config(std::string_view name);

}  // namespace fleetloc
