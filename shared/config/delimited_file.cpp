#include "shared/config/delimited_file.hpp"

#include <charconv>
#include <cmath>

namespace fleetloc {
namespace {

constexpr std::string_view kBlanks = " \t\r";

template <typename Number>
bool parse(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

bool is_digits(std::string_view text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

DelimitedFile::DelimitedFile(std::filesystem::path file, char separator)
    : file_(std::move(file)), separator_(separator) {
  if (!std::filesystem::is_regular_file(file_)) {
    throw TextFileError(file_.string() + ": no such file");
  }
  stream_.open(file_);
  if (!stream_) throw TextFileError(file_.string() + ": cannot be opened");
}

bool DelimitedFile::next() {
  while (std::getline(stream_, line_)) {
    ++line_number_;
    const std::size_t first = line_.find_first_not_of(kBlanks);
    if (first == std::string::npos || line_[first] == '#') continue;
    split();
    return true;
  }
  if (stream_.bad()) throw TextFileError(file_.string() + ": cannot be read");
  return false;
}

void DelimitedFile::split() {
  fields_.clear();
  const std::string separators =
      separator_ == ' ' ? std::string(kBlanks) : std::string(1, separator_);
  std::size_t begin = 0;
  while (true) {
    std::size_t end = line_.find_first_of(separators, begin);
    if (end == std::string::npos) end = line_.size();
    const std::size_t first = line_.find_first_not_of(kBlanks, begin);
    if (first >= end) {  // empty
      if (separator_ != ' ') fields_.emplace_back(begin, 0);
    } else {
      const std::size_t last = line_.find_last_not_of(kBlanks, end - 1);
      fields_.emplace_back(first, last + 1 - first);
    }
    if (end == line_.size()) return;
    begin = end + 1;
  }
}

void DelimitedFile::expect_columns(std::size_t columns) const {
  if (fields_.size() != columns) {
    fail(std::to_string(fields_.size()) + " columns instead of " + std::to_string(columns));
  }
}

std::string_view DelimitedFile::text(std::size_t column) const {
  if (column >= fields_.size()) fail("column " + std::to_string(column + 1) + " is missing");
  const auto [begin, length] = fields_[column];
  return std::string_view(line_).substr(begin, length);
}

double DelimitedFile::number(std::size_t column) const {
  double value = 0.0;
  if (!parse(text(column), value) || !std::isfinite(value)) {
    fail("'" + std::string(text(column)) + "' is not a finite number");
  }
  return value;
}

Timestamp DelimitedFile::nanoseconds(std::size_t column) const {
  std::int64_t value = 0;
  if (!parse(text(column), value)) {
    fail("'" + std::string(text(column)) + "' is not a stamp in nanoseconds");
  }
  constexpr std::int64_t kFarthest = std::int64_t{1} << 62;  // so that no difference overflows
  if (value < -kFarthest || value > kFarthest) {
    fail("'" + std::string(text(column)) + "' is too large for a stamp");
  }
  return Timestamp(Duration(value));
}

Timestamp DelimitedFile::seconds(std::size_t column) const {
  constexpr std::size_t kDecimals = 9;
  const std::string_view value = text(column);
  const std::size_t point = value.find('.');
  const std::string_view whole = value.substr(0, point);
  std::string decimals(point == std::string_view::npos ? "" : value.substr(point + 1));
  std::int64_t seconds = 0;
  std::int64_t nanoseconds = 0;
  const bool plain = is_digits(whole) && (decimals.empty() || is_digits(decimals));
  decimals.resize(kDecimals, '0');
  if (!plain || !parse(whole, seconds) || !parse(std::string_view(decimals), nanoseconds)) {
    fail("'" + std::string(value) + "' is not a stamp in seconds");
  }
  constexpr std::int64_t kLastSecond = 9'000'000'000;  // what 64 bits hold in nanoseconds
  if (seconds > kLastSecond) fail("'" + std::string(value) + "' is too large for a stamp");
  return Timestamp(std::chrono::seconds(seconds) + Duration(nanoseconds));
}

void DelimitedFile::fail(const std::string& message) const {
  throw TextFileError(file_.string() + ":" + std::to_string(line_number_) + ": " + message);
}

}  // namespace fleetloc
