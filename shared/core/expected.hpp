#pragma once

#include <tl/expected.hpp>

namespace fleetloc {

/// A value, or the reason why there is none: how everything that is expected to fail at run time
/// says why. Reasons are enums with a function `std::string_view name(Reason)`, and that name is
/// what reaches log, wire and summary. C++23's std::expected, until it can be used.
using tl::expected;
using tl::unexpected;

}  // namespace fleetloc
