#include "deploy/evaluation/report/html.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace fleetloc {
namespace {

std::string row(const std::vector<std::string>& cells, const char* first, const char* others) {
  std::string html = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string tag = i == 0 ? first : others;
    html += "<" + tag + ">" + cells[i] + "</" + tag.substr(0, 2) + ">";
  }
  return html + "</tr>\n";
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

std::string table(const std::vector<std::string>& header,
                  const std::vector<std::vector<std::string>>& rows,
                  bool numbers) {
  std::string html = "<div class=\"scroll\"><table";
  if (numbers) html += " class=\"numbers\"";
  html +=
      ">\n<thead>" + row(header, "th scope=\"col\"", "th scope=\"col\"") + "</thead>\n<tbody>\n";
  for (const auto& cells : rows) html += row(cells, "th scope=\"row\"", "td");
  return html + "</tbody>\n</table></div>\n";
}

std::string number_text(double value, int digits) {
  std::array<char, 64> text{};
  if (std::abs(value) >= 1e4 && std::abs(value) < 1e15) {
    std::snprintf(text.data(), text.size(), "%.0f", value);
  } else {
    std::snprintf(text.data(), text.size(), "%.*g", digits, value);
  }
  return text.data();
}

}  // namespace fleetloc
