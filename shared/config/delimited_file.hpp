#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/core/time.hpp"

namespace fleetloc {

/// A text file that cannot be read. The message names file and line.
class TextFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Reads a text file of fields line by line. Empty lines and lines that start with '#' are skipped,
/// and fields are trimmed. Every member that reads throws TextFileError.
class DelimitedFile {
 public:
  /// @param separator  of the fields; ' ' stands for any run of blanks
  DelimitedFile(std::filesystem::path file, char separator);

  /// Moves on to the next line. False at the end of the file.
  bool next();

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] std::size_t line() const { return line_number_; }  ///< from 1
  [[nodiscard]] std::size_t columns() const { return fields_.size(); }
  void expect_columns(std::size_t columns) const;

  [[nodiscard]] std::string_view text(std::size_t column) const;
  [[nodiscard]] double number(std::size_t column) const;  ///< finite
  [[nodiscard]] Timestamp nanoseconds(std::size_t column) const;
  [[nodiscard]] Timestamp seconds(std::size_t column) const;  ///< exact, not by way of a double

  /// Throws "file:line: message".
  [[noreturn]] void fail(const std::string& message) const;

 private:
  void split();

  std::filesystem::path file_;
  char separator_;
  std::ifstream stream_;
  std::string line_;
  std::size_t line_number_ = 0;
  std::vector<std::pair<std::size_t, std::size_t>> fields_;  // begin and length in line_
};

}  // namespace fleetloc
