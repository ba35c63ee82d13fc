#include "deploy/evaluation/experiment/fingerprint.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace fleetloc {
namespace {

bool is_text(const std::filesystem::path& file) {
  const auto extension = file.extension();
  return extension == ".csv" || extension == ".yaml" || extension == ".tum";
}

}  // namespace

void Fingerprint::mix(std::string_view bytes) {
  constexpr std::uint64_t kPrime = 0x100000001b3U;
  for (const char byte : bytes) {
    hash_ = (hash_ ^ static_cast<unsigned char>(byte)) * kPrime;
  }
}

Fingerprint& Fingerprint::add(std::string_view name, std::string_view value) {
  for (const std::string_view part : {name, value}) {
    mix(std::to_string(part.size()) + ":");
    mix(part);
  }
  return *this;
}

Fingerprint& Fingerprint::add_file(std::string_view name, const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::array<char, 1U << 16U> block{};
  add(name, "file");
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0) {
    mix({block.data(), static_cast<std::size_t>(stream.gcount())});
  }
  if (!stream.eof()) throw std::runtime_error(file.string() + ": cannot be read");
  return *this;
}

Fingerprint& Fingerprint::add_folder(std::string_view name, const std::filesystem::path& folder) {
  add(name, "folder");
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const auto& file : files) {
    const std::string relative = file.lexically_relative(folder).generic_string();
    add(relative, std::to_string(std::filesystem::file_size(file)));
    if (is_text(file)) add_file(relative, file);
  }
  return *this;
}

std::string Fingerprint::text() const {
  std::array<char, 17> digits{};
  std::snprintf(digits.data(), digits.size(), "%016llx", static_cast<unsigned long long>(hash_));
  return digits.data();
}

}  // namespace fleetloc
