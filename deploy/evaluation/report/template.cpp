#include "deploy/evaluation/report/template.hpp"

#include <stdexcept>

#include <kainjow/mustache.hpp>

namespace fleetloc {

std::string filled(std::string_view text, const TemplateValues& values) {
  kainjow::mustache::mustache page{std::string(text)};
  if (!page.is_valid()) throw std::logic_error("template: " + page.error_message());
  page.set_custom_escape([](const std::string& html) { return html; });
  kainjow::mustache::data data;
  for (const auto& [name, value] : values) {
    if (!value.empty()) data.set(name, value);  // sections of what is absent are left out
  }
  return page.render(data);
}

}  // namespace fleetloc
