#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <vector>

#include "test/fuzz/target.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {

/// In the folder of the process; replaces what has been there.
inline std::filesystem::path input_file(std::string_view name, std::string_view content) {
  const auto file = test_folder() / name;
  std::ofstream stream(file, std::ios::binary);
  stream << content;
  stream.close();
  require(static_cast<bool>(stream), "there is room for the input");
  return file;
}

inline std::filesystem::path input_file(std::string_view name,
                                        const std::uint8_t* data,
                                        std::size_t size) {
  return input_file(name, std::string_view(reinterpret_cast<const char*>(data), size));
}

/// An input for several files: they follow one another, a zero between them. Files that are missing
/// at the end are empty.
inline std::vector<std::string_view> input_parts(const std::uint8_t* data,
                                                 std::size_t size,
                                                 std::size_t count) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::vector<std::string_view> parts;
  while (parts.size() + 1 < count) {
    const std::size_t end = std::min(rest.find('\0'), rest.size());
    parts.push_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  parts.push_back(rest);
  return parts;
}

}  // namespace fleetloc
