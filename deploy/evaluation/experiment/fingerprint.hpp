#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace fleetloc {

/// A hash by which work that has been done is found again (FNV-1a, 64 bit). Not against intent.
class Fingerprint {
 public:
  /// A named part; parts do not run into each other.
  Fingerprint& add(std::string_view name, std::string_view value);
  /// The content of a file. Throws std::runtime_error if it cannot be read.
  Fingerprint& add_file(std::string_view name, const std::filesystem::path& file);
  /// Every file below a folder by path and size, and those of text (csv, yaml, tum) by content.
  Fingerprint& add_folder(std::string_view name, const std::filesystem::path& folder);

  /// 16 hexadecimal digits.
  [[nodiscard]] std::string text() const;

 private:
  void mix(std::string_view bytes);

  std::uint64_t hash_ = 0xcbf29ce484222325U;
};

}  // namespace fleetloc
