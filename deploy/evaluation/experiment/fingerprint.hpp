#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct XXH3_state_s;

namespace fleetloc {

/// A hash that identifies work that has been done (XXH3, 64 bit); not cryptographic.
class Fingerprint {
 public:
  Fingerprint();

  /// A named part; the boundaries of parts are hashed as well.
  Fingerprint& add(std::string_view name, std::string_view value);
  /// The content of a file. Throws std::runtime_error if it cannot be read.
  Fingerprint& add_file(std::string_view name, const std::filesystem::path& file);
  /// Every file below a folder, by path and content. Throws std::runtime_error.
  Fingerprint& add_folder(std::string_view name, const std::filesystem::path& folder);

  /// 16 hexadecimal digits.
  [[nodiscard]] std::string text() const;

 private:
  struct Free {
    void operator()(XXH3_state_s* state) const;
  };
  void mix(std::string_view bytes);

  std::unique_ptr<XXH3_state_s, Free> state_;
};

}  // namespace fleetloc
