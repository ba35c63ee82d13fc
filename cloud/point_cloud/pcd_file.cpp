#include "cloud/point_cloud/pcd_file.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <istream>
#include <sstream>
#include <string_view>

namespace fleetloc {
namespace {

static_assert(std::endian::native == std::endian::little);  // as in binary files

enum class PcdEncoding { kAscii, kBinary, kCompressed };

struct PcdField {
  std::string name;
  std::size_t bytes = 0;  // of a value
  char type = 0;
  std::size_t count = 1;   // of values
  std::size_t offset = 0;  // in a point
  std::size_t word = 0;    // of the first value in a line
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::uint32_t points = 0;
  PcdEncoding encoding = PcdEncoding::kAscii;
  std::size_t point_bytes = 0;
  std::size_t point_words = 0;
};

/// The next word of a line of the header; of another kind, or not there: nothing is returned.
std::uint32_t whole_number(std::istream& words) {
  std::string word;
  std::uint32_t number = 0;
  words >> word;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) words.setstate(std::ios::failbit);
  return number;
}

PcdEncoding pcd_encoding_named(const std::string& name) {
  if (name == "ascii") return PcdEncoding::kAscii;
  if (name == "binary") return PcdEncoding::kBinary;
  if (name == "binary_compressed") return PcdEncoding::kCompressed;
  throw PointCloudError("unknown data '" + name + "'");
}

void read_field_names(std::istream& words, PcdHeader& header) {
  header.fields.clear();
  for (std::string name; words >> name;) header.fields.push_back({.name = name});
  words.clear();
}

/// @return false for a line that is none of a PCD file
bool read_pcd_line(const std::string& keyword, std::istream& words, PcdHeader& header) {
  if (keyword == "FIELDS" || keyword == "COLUMNS") {
    read_field_names(words, header);
  } else if (keyword == "SIZE") {
    for (PcdField& field : header.fields) field.bytes = whole_number(words);
  } else if (keyword == "TYPE") {
    for (PcdField& field : header.fields) words >> field.type;
  } else if (keyword == "COUNT") {
    for (PcdField& field : header.fields) field.count = whole_number(words);
  } else if (keyword == "WIDTH") {
    header.width = whole_number(words);
  } else if (keyword == "HEIGHT") {
    header.height = whole_number(words);
  } else if (keyword == "POINTS") {
    header.points = whole_number(words);
  } else {
    return keyword == "VERSION" || keyword == "VIEWPOINT";
  }
  return true;
}

void lay_out(PcdHeader& header) {
  constexpr std::size_t kMaxValues = 65'536;  // of a point
  for (PcdField& field : header.fields) {
    if (!std::has_single_bit(field.bytes) || field.bytes > 8 || field.count == 0 ||
        field.count > kMaxValues) {
      throw PointCloudError("field '" + field.name + "' has no valid size or count");
    }
    field.offset = header.point_bytes;
    field.word = header.point_words;
    header.point_bytes += field.bytes * field.count;
    header.point_words += field.count;
    if (header.point_words > kMaxValues) throw PointCloudError("has too many values for a point");
  }
}

PcdHeader read_pcd_header(std::istream& stream) {
  PcdHeader header;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string keyword;
    words >> keyword;
    if (keyword.empty() || keyword.starts_with('#')) continue;
    if (keyword == "DATA") {
      std::string name;
      words >> name;
      header.encoding = pcd_encoding_named(name);
      lay_out(header);
      return header;
    }
    if (!read_pcd_line(keyword, words, header)) throw PointCloudError("not a PCD file");
    if (words.fail()) throw PointCloudError("malformed line in the header: '" + line + "'");
  }
  throw PointCloudError("ends within its header");
}

template <typename T>
float value_at(const char* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<float>(value);
}

using Load = float (*)(const char*);

/// Null for a type that there is not.
Load loader(const PcdField& field) {
  switch (field.type) {
    case 'F':
      return field.bytes == 4 ? value_at<float> : field.bytes == 8 ? value_at<double> : nullptr;
    case 'I':
      return field.bytes == 1   ? value_at<std::int8_t>
             : field.bytes == 2 ? value_at<std::int16_t>
             : field.bytes == 4 ? value_at<std::int32_t>
                                : value_at<std::int64_t>;
    case 'U':
      return field.bytes == 1   ? value_at<std::uint8_t>
             : field.bytes == 2 ? value_at<std::uint16_t>
             : field.bytes == 4 ? value_at<std::uint32_t>
                                : value_at<std::uint64_t>;
    default:
      return nullptr;
  }
}

/// A column of the table, and the field that it is read from.
struct Column {
  const PcdField* field = nullptr;
  Load load = nullptr;
};

std::vector<Column> columns_of(const PcdHeader& header, const std::vector<std::string>& fields) {
  std::vector<Column> columns;
  for (const std::string& name : fields) {
    const auto field = std::ranges::find(header.fields, name, &PcdField::name);
    if (field == header.fields.end()) {
      throw PointCloudError("its points have no field '" + name + "'");
    }
    columns.push_back({.field = &*field, .load = loader(*field)});
    if (columns.back().load == nullptr) {
      throw PointCloudError("field '" + name + "' is of an unknown type");
    }
  }
  return columns;
}

[[noreturn]] void fail_at_end() {
  throw PointCloudError("ends before its last point, or is damaged");
}

float number_in(const std::string& word) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);  // also takes nan and inf
  if (end == word.c_str() || *end != '\0') fail_at_end();
  return static_cast<float>(value);
}

// Rows are added as they come: a damaged header may promise more than any memory holds.
PointTable read_words(std::istream& stream,
                      const PcdHeader& header,
                      const std::vector<Column>& columns) {
  std::vector<float> table;
  std::vector<std::string> words(header.point_words);
  for (std::uint32_t i = 0; i < header.points; ++i) {
    for (std::string& word : words) {
      if (!(stream >> word)) fail_at_end();
    }
    for (const Column& column : columns) table.push_back(number_in(words[column.field->word]));
  }
  return Eigen::Map<const PointTable>(table.data(),
                                      static_cast<Eigen::Index>(header.points),
                                      static_cast<Eigen::Index>(columns.size()));
}

std::uint64_t bytes_left(std::istream& stream) {
  const auto at = stream.tellg();
  stream.seekg(0, std::ios::end);
  const auto end = stream.tellg();
  stream.seekg(at);
  return stream ? static_cast<std::uint64_t>(end - at) : 0;
}

PointTable empty_table(const PcdHeader& header, const std::vector<Column>& columns) {
  return {static_cast<Eigen::Index>(header.points), static_cast<Eigen::Index>(columns.size())};
}

/// Point by point.
PointTable read_binary(std::istream& stream,
                       const PcdHeader& header,
                       const std::vector<Column>& columns) {
  if (bytes_left(stream) / header.point_bytes < header.points) fail_at_end();
  PointTable table = empty_table(header, columns);
  std::string point(header.point_bytes, '\0');
  for (float* value = table.data(); value != table.data() + table.size();) {
    stream.read(point.data(), static_cast<std::streamsize>(point.size()));
    if (!stream) fail_at_end();
    for (const Column& column : columns) *value++ = column.load(&point[column.field->offset]);
  }
  return table;
}

/// LZF (Lehmann): runs of bytes as they are, and copies of what came before.
/// @return what is not longer than `size`; shorter if `packed` is damaged
std::string unpacked(std::string_view packed, std::size_t size) {
  constexpr std::size_t kLiteral = 32;  // control bytes below announce so many bytes and one
  std::string out;
  const auto next = [&packed] {
    if (packed.empty()) return std::size_t{0};
    const auto byte = static_cast<std::uint8_t>(packed.front());
    packed.remove_prefix(1);
    return std::size_t{byte};
  };
  while (!packed.empty() && out.size() < size) {
    const std::size_t control = next();
    if (control < kLiteral) {
      const std::string_view literal = packed.substr(0, control + 1);
      out += literal;
      packed.remove_prefix(literal.size());
      continue;
    }
    std::size_t length = control >> 5U;
    if (length == 7) length += next();
    const std::size_t back = ((control & 0x1fU) << 8U) + next() + 1;
    if (back > out.size()) return out;
    for (std::size_t i = 0; i < length + 2; ++i) out += out[out.size() - back];
  }
  out.resize(std::min(out.size(), size));
  return out;
}

/// Field by field.
PointTable read_compressed(std::istream& stream,
                           const PcdHeader& header,
                           const std::vector<Column>& columns) {
  std::uint32_t packed_bytes = 0;
  std::uint32_t bytes = 0;
  stream.read(reinterpret_cast<char*>(&packed_bytes), sizeof(packed_bytes));
  stream.read(reinterpret_cast<char*>(&bytes), sizeof(bytes));
  if (!stream || bytes_left(stream) < packed_bytes || bytes / header.point_bytes < header.points) {
    fail_at_end();
  }
  std::string packed(packed_bytes, '\0');
  stream.read(packed.data(), static_cast<std::streamsize>(packed.size()));
  const std::string data = unpacked(packed, bytes);
  if (!stream || data.size() < bytes) fail_at_end();
  PointTable table = empty_table(header, columns);
  float* value = table.data();
  for (std::size_t i = 0; i < header.points; ++i) {
    for (const auto& [field, load] : columns) {
      *value++ = load(&data[header.points * field->offset + i * field->bytes * field->count]);
    }
  }
  return table;
}

PointTable read_points_of(std::istream& stream, const std::vector<std::string>& fields) {
  PcdHeader header = read_pcd_header(stream);
  if (header.width == 0 || header.height == 0 || header.points == 0) {
    throw PointCloudError("holds no points");
  }
  if (std::uint64_t{header.width} * header.height != header.points) {
    throw PointCloudError("WIDTH times HEIGHT is not POINTS");
  }
  const std::vector<Column> columns = columns_of(header, fields);
  switch (header.encoding) {
    case PcdEncoding::kAscii:
      return read_words(stream, header, columns);
    case PcdEncoding::kBinary:
      return read_binary(stream, header, columns);
    case PcdEncoding::kCompressed:
      return read_compressed(stream, header, columns);
  }
  return {};
}

}  // namespace

PointTable read_pcd(const std::filesystem::path& file, const std::vector<std::string>& fields) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw PointCloudError(file.string() + ": cannot be opened");
  try {
    return read_points_of(stream, fields);
  } catch (const PointCloudError& error) {
    throw PointCloudError(file.string() + ": " + error.what());
  }
}

}  // namespace fleetloc
