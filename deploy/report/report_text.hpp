#pragma once

#include <string_view>

namespace fleetloc {

// The files beside this one, at build time.
std::string_view page_html();
std::string_view run_html();
std::string_view style_css();

}  // namespace fleetloc
