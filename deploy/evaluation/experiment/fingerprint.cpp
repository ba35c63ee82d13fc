#include "deploy/evaluation/experiment/fingerprint.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <xxhash.h>

namespace fleetloc {

Fingerprint::Fingerprint() : state_(XXH3_createState()) {
  XXH3_64bits_reset(state_.get());
}

void Fingerprint::Free::operator()(XXH3_state_s* state) const {
  XXH3_freeState(state);
}

void Fingerprint::mix(std::string_view bytes) {
  XXH3_64bits_update(state_.get(), bytes.data(), bytes.size());
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
  std::uint64_t size = 0;
  add(name, "file");
  while (stream.read(block.data(), block.size()) || stream.gcount() > 0) {
    mix({block.data(), static_cast<std::size_t>(stream.gcount())});
    size += static_cast<std::uint64_t>(stream.gcount());
  }
  if (!stream.eof()) throw std::runtime_error(file.string() + ": cannot be read");
  return add("size", std::to_string(size));
}

Fingerprint& Fingerprint::add_folder(std::string_view name, const std::filesystem::path& folder) {
  add(name, "folder");
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const auto& file : files) add_file(file.lexically_relative(folder).generic_string(), file);
  return *this;
}

std::string Fingerprint::text() const {
  std::array<char, 17> digits{};
  const auto hash = static_cast<unsigned long long>(XXH3_64bits_digest(state_.get()));
  std::snprintf(digits.data(), digits.size(), "%016llx", hash);
  return digits.data();
}

}  // namespace fleetloc
