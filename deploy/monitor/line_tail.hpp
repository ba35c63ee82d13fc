#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace fleetloc {

/// Reads a text file while another program writes it, or begins it anew.
class LineTail {
 public:
  explicit LineTail(std::filesystem::path file) : file_(std::move(file)) {}

  /// The complete lines that have been added since the last call; none while there is no file.
  std::vector<std::string> new_lines();

 private:
  [[nodiscard]] bool is_begun_anew();

  std::filesystem::path file_;
  std::ifstream stream_;
  std::string begun_;  // a line without an end so far
};

/// A table with a header whose lines are added one by one.
class CsvTail {
 public:
  explicit CsvTail(std::filesystem::path file) : lines_(std::move(file)) {}

  /// Calls `take()` for each new line, in which text() then finds the fields.
  template <typename Take>
  void read(const Take& take) {
    for (const std::string& line : lines_.new_lines()) {
      if (set_line(line)) take();
    }
  }

  /// Empty without such a column.
  [[nodiscard]] std::string text(const std::string& column) const;
  /// NaN if it is not a number.
  [[nodiscard]] double number(const std::string& column) const;

 private:
  bool set_line(const std::string& line);

  LineTail lines_;
  std::vector<std::string> header_;
  std::vector<std::string> fields_;
};

}  // namespace fleetloc
