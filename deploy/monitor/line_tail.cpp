#include "deploy/monitor/line_tail.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <utility>

namespace fleetloc {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  return fields;
}

}  // namespace

std::vector<std::string> LineTail::new_lines() {
  std::vector<std::string> lines;
  stream_.clear();  // the end of the file that the last call met
  if (!stream_.is_open() || is_begun_anew()) {
    stream_ = std::ifstream(file_);
    begun_.clear();
  }
  for (std::string part; std::getline(stream_, part);) {
    begun_ += part;
    if (stream_.eof()) break;  // met before the end of the line
    lines.push_back(std::exchange(begun_, {}));
  }
  return lines;
}

bool LineTail::is_begun_anew() {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file_, error);
  return !error && size < static_cast<std::uintmax_t>(stream_.tellg());
}

bool CsvTail::set_line(const std::string& line) {
  fields_ = split(line);
  if (fields_ == header_) return false;  // of the file that was begun anew
  if (!header_.empty()) return fields_.size() == header_.size();
  header_ = std::exchange(fields_, {});
  return false;
}

std::string CsvTail::text(const std::string& column) const {
  const auto found = std::ranges::find(header_, column);
  if (found == header_.end()) return {};
  return fields_[static_cast<std::size_t>(found - header_.begin())];
}

double CsvTail::number(const std::string& column) const {
  const std::string value = text(column);
  char* end = nullptr;
  const double result = std::strtod(value.c_str(), &end);
  return value.empty() || *end != '\0' ? std::numeric_limits<double>::quiet_NaN() : result;
}

}  // namespace fleetloc
