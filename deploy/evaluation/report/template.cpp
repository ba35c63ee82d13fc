#include "deploy/evaluation/report/template.hpp"

#include <stdexcept>

namespace fleetloc {
namespace {

/// What stands before `end`; both are taken away from the text.
std::string_view taken(std::string_view& text, std::string_view end) {
  const std::size_t at = text.find(end);
  if (at == std::string_view::npos) throw std::logic_error("template: no " + std::string(end));
  const std::string_view before = text.substr(0, at);
  text.remove_prefix(at + end.size());
  return before;
}

bool is_block(std::string_view tag) {
  return tag.starts_with('#') || tag.starts_with('^');
}

}  // namespace

std::string filled(std::string_view text, const TemplateValues& values) {
  std::string html;
  while (text.find("{{") != std::string_view::npos) {
    html += taken(text, "{{");
    const std::string_view tag = taken(text, "}}");
    const std::string name(is_block(tag) ? tag.substr(1) : tag);
    const auto found = values.find(name);
    const std::string value = found == values.end() ? "" : found->second;
    if (!is_block(tag)) {
      html += value;
      continue;
    }
    const std::string_view block = taken(text, "{{/" + name + "}}");
    if (value.empty() == tag.starts_with('^')) html += filled(block, values);
  }
  return html.append(text);
}

}  // namespace fleetloc
