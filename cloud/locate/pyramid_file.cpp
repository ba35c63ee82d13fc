#include "cloud/locate/pyramid_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

#include <xxhash.h>

namespace fleetloc {
namespace {

static_assert(std::endian::native == std::endian::little);

// The number goes up with whatever makes another grid or ground of the same map.
constexpr std::string_view kFirstLine = "fleetloc map pyramid 1\n";

std::uint64_t checksum(std::string_view content) {
  return XXH3_64bits(content.data(), content.size());
}

template <typename T>
requires std::is_trivially_copyable_v<T>
void append(std::string& content, const T& value) {
  content.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <typename T>
void append(std::string& content, const std::vector<T>& values) {
  append(content, static_cast<std::uint64_t>(values.size()));
  content.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

void append(std::string& content, const Eigen::Vector3i& cell) {
  for (const int coordinate : cell) append(content, coordinate);
}

/// Takes values from the front of a text; once it is too short all are zero.
class Content {
 public:
  explicit Content(std::string_view text) : text_(text) {}

  template <typename T>
  T take() {
    T value{};
    if (text_.size() < sizeof(T)) {
      is_short_ = true;
      return value;
    }
    std::memcpy(&value, text_.data(), sizeof(T));
    text_.remove_prefix(sizeof(T));
    return value;
  }

  template <typename T>
  std::vector<T> take_all() {
    const auto size = take<std::uint64_t>();
    if (size > text_.size() / sizeof(T)) {
      is_short_ = true;
      return {};
    }
    std::vector<T> values(size);
    if (size == 0) return values;
    std::memcpy(values.data(), text_.data(), size * sizeof(T));
    text_.remove_prefix(size * sizeof(T));
    return values;
  }

  Eigen::Vector3i take_cell() {
    const int x = take<int>();
    const int y = take<int>();
    const int z = take<int>();
    return {x, y, z};
  }

  /// Whether the text had exactly what was taken.
  [[nodiscard]] bool is_all() const { return !is_short_ && text_.empty(); }

 private:
  std::string_view text_;
  bool is_short_ = false;
};

std::string content_of(const MapPyramid& pyramid,
                       const MapPyramid::Config& config,
                       const MapHash& map) {
  std::string content(kFirstLine);
  append(content, map);
  append(content, config.cell_m);
  append(content, config.level_from);
  const GroundHeights& ground = pyramid.ground();
  append(content, ground.min_map().x());
  append(content, ground.min_map().y());
  append(content, ground.width());
  append(content, ground.depth());
  append(content, ground.heights());
  append(content, pyramid.min());
  append(content, pyramid.max());
  append(content, pyramid.values().directory());
  append(content, pyramid.values().bricks());
  append(content, checksum(content));
  return content;
}

std::optional<std::string> read(const std::filesystem::path& file) {
  if (!std::filesystem::is_regular_file(file)) return std::nullopt;
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream) return std::nullopt;
  std::string text(static_cast<std::size_t>(std::max<std::streamoff>(0, stream.tellg())), '\0');
  stream.seekg(0);
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return text;
}

/// Nothing if it is not of width x depth cells, or farther away than any place on earth.
std::optional<GroundHeights> take_ground(Content& content) {
  constexpr double kFarthest_m = 1e8;
  const auto x = content.take<double>();
  const auto y = content.take<double>();
  const auto width = content.take<int>();
  const auto depth = content.take<int>();
  auto heights = content.take_all<float>();
  const bool is_near = std::abs(x) <= kFarthest_m && std::abs(y) <= kFarthest_m;
  const bool are_finite = std::ranges::all_of(heights, [](float z) { return std::isfinite(z); });
  if (!is_near || !are_finite || width < 1 || depth < 1 ||
      heights.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(depth)) {
    return std::nullopt;
  }
  return GroundHeights({x, y}, width, depth, std::move(heights));
}

std::optional<CellGrid> take_grid(Content& content) {
  const Eigen::Vector3i min = content.take_cell();
  const Eigen::Vector3i max = content.take_cell();
  auto directory = content.take_all<std::uint32_t>();
  auto bricks = content.take_all<CellGrid::Brick>();
  if (!content.is_all()) return std::nullopt;
  return CellGrid::of_parts(min, max, std::move(directory), std::move(bricks));
}

}  // namespace

std::filesystem::path pyramid_file(const std::filesystem::path& pcd_file) {
  return std::filesystem::path(pcd_file).replace_extension(".pyramid");
}

void save_pyramid(const MapPyramid& pyramid,
                  const MapPyramid::Config& config,
                  const MapHash& map,
                  const std::filesystem::path& file) {
  const std::string content = content_of(pyramid, config, map);
  std::filesystem::path written = file;
  written += ".new";
  std::ofstream stream(written, std::ios::binary);
  stream.write(content.data(), static_cast<std::streamsize>(content.size()));
  stream.close();
  std::error_code error;
  if (!stream) {
    std::filesystem::remove(written, error);
    throw PyramidFileError(file.string() + ": cannot be written");
  }
  std::filesystem::rename(written, file, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(written, ignored);
    throw PyramidFileError(file.string() + ": " + error.message());
  }
}

expected<MapPyramid, std::string> load_pyramid(const std::filesystem::path& file,
                                               const MapHash& map,
                                               const MapPyramid::Config& config) {
  const std::optional<std::string> text = read(file);
  if (!text) return unexpected<std::string>("is not there, or cannot be read");
  if (!text->starts_with(kFirstLine)) return unexpected<std::string>("is no map pyramid of ours");
  const std::string_view all(*text);
  const std::size_t end = all.size() - std::min(all.size(), sizeof(std::uint64_t));
  if (Content(all.substr(end)).take<std::uint64_t>() != checksum(all.substr(0, end))) {
    return unexpected<std::string>("is damaged");
  }
  Content content(all.substr(0, end).substr(kFirstLine.size()));
  if (content.take<MapHash>() != map) return unexpected<std::string>("is of another map");
  const bool has_these_cells =
      content.take<double>() == config.cell_m && content.take<double>() == config.level_from;
  if (!has_these_cells) return unexpected<std::string>("has other cells than configured");
  std::optional<GroundHeights> ground = take_ground(content);
  std::optional<CellGrid> values = take_grid(content);
  if (!ground || !values) return unexpected<std::string>("is damaged");
  return MapPyramid(std::move(*ground), std::move(*values), config);
}

}  // namespace fleetloc
