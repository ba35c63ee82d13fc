#pragma once

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "shared/link/channel.hpp"

namespace fleetloc {

/// Valid inputs, in a folder for each target.
class SeedFolder {
 public:
  explicit SeedFolder(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void add(const std::string& target, const std::string& name, std::string_view bytes) const {
    std::filesystem::create_directories(folder_ / target);
    const auto file = folder_ / target / name;
    std::ofstream stream(file, std::ios::binary);
    stream << bytes;
    stream.close();
    if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
  }
  void add(const std::string& target, const std::string& name, const Bytes& bytes) const {
    add(target, name, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  }

 private:
  std::filesystem::path folder_;
};

/// What was written to a file, or belongs to the project. Throws std::runtime_error.
inline std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string content{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  return content;
}

/// Of an input for several files, see input_parts().
inline std::string joined(std::initializer_list<std::string_view> parts) {
  std::string all;
  for (const std::string_view part : parts) {
    if (part.data() != parts.begin()->data()) all += '\0';
    all += part;
  }
  return all;
}

void add_wire_seeds(const SeedFolder& seeds);
void add_ros2_seeds(const SeedFolder& seeds);
void add_rtps_seeds(const SeedFolder& seeds);
void add_map_seeds(const SeedFolder& seeds);        ///< point clouds, maps and what belongs to them
void add_recording_seeds(const SeedFolder& seeds);  ///< and what runs write
void add_config_seeds(const SeedFolder& seeds);

}  // namespace fleetloc
