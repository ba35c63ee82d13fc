#include "cloud/point_cloud/ply_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <istream>
#include <map>
#include <optional>
#include <sstream>

namespace fleetloc {
namespace {

enum class Encoding { kAscii, kLittleEndian, kBigEndian };

struct ScalarType {
  std::size_t bytes = 0;
  enum class Kind { kSigned, kUnsigned, kFloat } kind = Kind::kFloat;
};

struct Property {
  std::string name;
  ScalarType type;                        // of the value, or of the items of a list
  std::optional<ScalarType> length_type;  // of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::kAscii;
  std::vector<Element> elements;
};

/// The types' names, of both generations of the format.
ScalarType scalar_type(const std::string& name) {
  using enum ScalarType::Kind;
  static const std::map<std::string, ScalarType> types = {{"char", {1, kSigned}},
                                                          {"int8", {1, kSigned}},
                                                          {"uchar", {1, kUnsigned}},
                                                          {"uint8", {1, kUnsigned}},
                                                          {"short", {2, kSigned}},
                                                          {"int16", {2, kSigned}},
                                                          {"ushort", {2, kUnsigned}},
                                                          {"uint16", {2, kUnsigned}},
                                                          {"int", {4, kSigned}},
                                                          {"int32", {4, kSigned}},
                                                          {"uint", {4, kUnsigned}},
                                                          {"uint32", {4, kUnsigned}},
                                                          {"float", {4, kFloat}},
                                                          {"float32", {4, kFloat}},
                                                          {"double", {8, kFloat}},
                                                          {"float64", {8, kFloat}}};
  const auto found = types.find(name);
  if (found == types.end()) throw PointCloudError("property of unknown type '" + name + "'");
  return found->second;
}

Encoding encoding_named(const std::string& name) {
  if (name == "ascii") return Encoding::kAscii;
  if (name == "binary_little_endian") return Encoding::kLittleEndian;
  if (name == "binary_big_endian") return Encoding::kBigEndian;
  throw PointCloudError("unknown format '" + name + "'");
}

Property read_property(std::istream& words) {
  Property property;
  std::string type;
  words >> type;
  if (type == "list") {
    std::string length_type;
    words >> length_type >> type;
    property.length_type = scalar_type(length_type);
  }
  property.type = scalar_type(type);
  words >> property.name;
  return property;
}

/// One line of the header after the first.
void read_header_line(const std::string& line, Header& header) {
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  if (keyword == "format") {
    std::string name;
    words >> name;
    header.encoding = encoding_named(name);
  } else if (keyword == "element") {
    Element element;
    words >> element.name >> element.count;
    header.elements.push_back(element);
  } else if (keyword == "property" && !header.elements.empty()) {
    header.elements.back().properties.push_back(read_property(words));
  } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
    throw PointCloudError("unknown line in the header: '" + line + "'");
  }
  if (words.fail() && !keyword.empty()) {
    throw PointCloudError("malformed line in the header: '" + line + "'");
  }
}

Header read_header(std::istream& stream) {
  Header header;
  std::string line;
  const auto next_line = [&] {
    if (!std::getline(stream, line)) throw PointCloudError("ends within its header");
    if (line.ends_with('\r')) line.pop_back();
  };
  next_line();
  if (line != "ply") throw PointCloudError("not a PLY file");
  for (next_line(); line != "end_header"; next_line()) read_header_line(line, header);
  return header;
}

template <typename Integer>
double integer_value(std::uint64_t bits) {
  return static_cast<double>(static_cast<Integer>(bits));
}

double value_of(std::uint64_t bits, const ScalarType& type) {
  if (type.kind == ScalarType::Kind::kFloat) {
    if (type.bytes == 8) return std::bit_cast<double>(bits);
    return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  }
  if (type.kind == ScalarType::Kind::kUnsigned) return static_cast<double>(bits);
  if (type.bytes == 1) return integer_value<std::int8_t>(bits);
  return type.bytes == 2 ? integer_value<std::int16_t>(bits) : integer_value<std::int32_t>(bits);
}

/// Reads the values that follow the header one by one.
class ValueStream {
 public:
  ValueStream(std::istream& stream, Encoding encoding) : stream_(stream), encoding_(encoding) {}

  double next(const ScalarType& type) {
    const double value = encoding_ == Encoding::kAscii ? next_word() : next_binary(type);
    if (!stream_) throw PointCloudError("ends before its last point, or is damaged");
    return value;
  }

 private:
  double next_word() {
    stream_ >> word_;
    char* end = nullptr;
    const double value = std::strtod(word_.c_str(), &end);  // also takes nan and inf
    if (end == word_.c_str() || *end != '\0') stream_.setstate(std::ios::failbit);
    return value;
  }

  double next_binary(const ScalarType& type) {
    std::array<char, 8> bytes{};
    stream_.read(bytes.data(), static_cast<std::streamsize>(type.bytes));
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < type.bytes; ++i) {
      const std::size_t from_top = encoding_ == Encoding::kLittleEndian ? type.bytes - 1 - i : i;
      bits = (bits << 8U) | static_cast<std::uint8_t>(bytes[from_top]);
    }
    return value_of(bits, type);
  }

  std::istream& stream_;
  Encoding encoding_;
  std::string word_;
};

/// Reads one item of `element`; its scalars land in `values`, one per property.
void read_item(ValueStream& stream, const Element& element, std::vector<double>& values) {
  values.clear();
  for (const Property& property : element.properties) {
    double value = 0.0;
    if (property.length_type) {
      const double length = stream.next(*property.length_type);
      if (!(length >= 0.0 && length < 1e9)) throw PointCloudError("a list has an absurd length");
      for (auto i = static_cast<std::size_t>(length); i > 0; --i) stream.next(property.type);
    } else {
      value = stream.next(property.type);
    }
    values.push_back(value);
  }
}

std::vector<std::size_t> vertex_columns(const Element& vertex,
                                        const std::vector<std::string>& fields) {
  std::vector<std::size_t> columns;
  for (const std::string& field : fields) {
    const auto found = std::ranges::find(vertex.properties, field, &Property::name);
    if (found == vertex.properties.end() || found->length_type) {
      throw PointCloudError("its points have no field '" + field + "'");
    }
    columns.push_back(static_cast<std::size_t>(found - vertex.properties.begin()));
  }
  return columns;
}

PointTable read_vertices(ValueStream& stream,
                         const Element& vertex,
                         const std::vector<std::string>& fields) {
  const auto columns = vertex_columns(vertex, fields);
  // Rows are added as they come: a damaged header may promise more than any memory holds.
  std::vector<float> table;
  std::vector<double> values;
  for (std::size_t i = 0; i < vertex.count; ++i) {
    read_item(stream, vertex, values);
    for (const std::size_t column : columns) table.push_back(static_cast<float>(values[column]));
  }
  return Eigen::Map<const PointTable>(table.data(),
                                      static_cast<Eigen::Index>(vertex.count),
                                      static_cast<Eigen::Index>(fields.size()));
}

PointTable read_table(std::istream& stream, const std::vector<std::string>& fields) {
  const Header header = read_header(stream);
  ValueStream values(stream, header.encoding);
  std::vector<double> skipped;
  for (const Element& element : header.elements) {
    if (element.name == "vertex" && element.count > 0) {
      return read_vertices(values, element, fields);
    }
    if (element.properties.empty()) continue;  // however many there are
    for (std::size_t i = 0; i < element.count; ++i) read_item(values, element, skipped);
  }
  throw PointCloudError("holds no points");
}

}  // namespace

PointTable read_ply(const std::filesystem::path& file, const std::vector<std::string>& fields) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw PointCloudError(file.string() + ": cannot be opened");
  try {
    return read_table(stream, fields);
  } catch (const PointCloudError& error) {
    throw PointCloudError(file.string() + ": " + error.what());
  }
}

}  // namespace fleetloc
