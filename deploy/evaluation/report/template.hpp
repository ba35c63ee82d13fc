#pragma once

#include <map>
#include <string>
#include <string_view>

namespace fleetloc {

/// Values of a template by name, as HTML. What is absent is empty.
using TemplateValues = std::map<std::string, std::string>;

/// Fills in a mustache template: replaces `{{name}}` by its value; keeps what stands between
/// `{{#name}}` and `{{/name}}` only if the value is not empty, and between `{{^name}}` and
/// `{{/name}}` only if it is. Values are taken as they are. Throws std::logic_error for a template
/// that is not well-formed.
std::string filled(std::string_view text, const TemplateValues& values);

}  // namespace fleetloc
