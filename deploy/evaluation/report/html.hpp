#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fleetloc {

/// Text as it may stand in HTML, also within an attribute's quotes.
std::string escaped(std::string_view text);

/// A table in a box of its own, which scrolls where the page is narrower. Cells are HTML.
/// @param numbers  all columns but the first are numbers
std::string table(const std::vector<std::string>& header,
                  const std::vector<std::vector<std::string>>& rows,
                  bool numbers = true);

/// At most `digits` significant digits, an exponent only for very large and very small numbers.
std::string number_text(double value, int digits = 4);

}  // namespace fleetloc
