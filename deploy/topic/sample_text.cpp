#include "deploy/topic/sample_text.hpp"

#include <algorithm>
#include <cctype>

namespace fleetloc {
namespace {

using Json = nlohmann::ordered_json;

std::string scalar(const Json& value) {
  if (!value.is_string()) return value.dump();
  const auto text = value.get<std::string>();
  const bool begins_plainly =
      !text.empty() && std::isalpha(static_cast<unsigned char>(text[0])) != 0;
  const bool is_plain = begins_plainly && std::ranges::all_of(text, [](char c) {
                          return c == '_' || c == '-' || c == '/' || c == ' ' || c == ',' ||
                                 c == '.' || std::isalnum(static_cast<unsigned char>(c)) != 0;
                        });
  return is_plain ? text : value.dump();
}

bool is_flat(const Json& array) {
  return std::ranges::none_of(array, [](const Json& one) { return one.is_structured(); });
}

std::string flat(const Json& array) {
  std::string out = "[";
  for (const Json& one : array) out += (out.size() > 1 ? ", " : "") + scalar(one);
  return out + "]";
}

void write(const Json& object, const std::string& indent, std::string& out);

void write_item(const Json& item, const std::string& indent, std::string& out) {
  if (item.is_array()) {
    out += indent + "- " + flat(item) + "\n";
  } else {
    std::string lines;
    write(item, indent + "  ", lines);
    lines[indent.size()] = '-';
    out += lines;
  }
}

void write(const Json& object, const std::string& indent, std::string& out) {
  for (const auto& [key, value] : object.items()) {
    out += indent + key + ":";
    if (value.is_object()) {
      out += "\n";
      write(value, indent + "  ", out);
    } else if (value.is_array() && !is_flat(value)) {
      out += "\n";
      for (const Json& item : value) write_item(item, indent + "  ", out);
    } else {
      out += " " + (value.is_array() ? flat(value) : scalar(value)) + "\n";
    }
  }
}

}  // namespace

std::string sample_text(const Json& sample) {
  std::string out;
  write(sample, "", out);
  return out;
}

}  // namespace fleetloc
