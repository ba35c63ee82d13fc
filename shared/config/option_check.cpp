#include "shared/config/option_check.hpp"

#include <charconv>
#include <cstdint>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>

namespace fleetloc {
namespace {

template <typename Number>
std::optional<Number> number_from(const std::string& text) {
  Number number{};
  const char* end = text.data() + text.size();
  const auto [parsed, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || parsed != end) return std::nullopt;
  return number;
}

std::string shown(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

// What a value should be is a part of the help and of the error.
template <typename IsGood>
CLI::Validator check(const std::string& wanted, const IsGood& is_good) {
  return CLI::Validator(
      [wanted, is_good](const std::string& text) {
        return is_good(text) ? std::string() : "'" + text + "' is not " + wanted;
      },
      wanted);
}

}  // namespace

CLI::Validator number_in(double min, double max) {
  return check(shown(min) + " to " + shown(max), [min, max](const std::string& text) {
    const auto number = number_from<double>(text);
    return number && *number >= min && *number <= max;
  });
}

CLI::Validator positive_up_to(double max) {
  return check("above 0 and up to " + shown(max), [max](const std::string& text) {
    const auto number = number_from<double>(text);
    return number && *number > 0.0 && *number <= max;
  });
}

CLI::Validator whole_number() {
  return check("a whole number from 0 on", [](const std::string& text) {
    return number_from<std::uint64_t>(text).has_value();
  });
}

}  // namespace fleetloc
