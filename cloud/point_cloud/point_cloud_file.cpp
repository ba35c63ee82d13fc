#include "cloud/point_cloud/point_cloud_file.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <fstream>

#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include "cloud/point_cloud/ply_file.hpp"
#include "cloud/point_cloud/quiet_pcl.hpp"

namespace fleetloc {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& reason) {
  throw PointCloudError(file.string() + ": " + reason);
}

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char letter) {
    return static_cast<char>(std::tolower(letter));
  });
  return extension;
}

/// PCL takes the missing end of a binary file for zeros, and does not survive a file without
/// points.
void expect_whole(const std::filesystem::path& file) {
  pcl::PCLPointCloud2 header;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0;
  int encoding = 0;  // 0: ASCII, 1: binary, 2: compressed
  unsigned int start = 0;
  pcl::PCDReader reader;
  if (reader.readHeader(file.string(), header, origin, orientation, version, encoding, start) < 0) {
    fail(file, "not a PCD file");
  }
  if (header.fields.empty()) fail(file, "not a PCD file");
  if (header.width == 0 || header.height == 0) fail(file, "holds no points");
  std::uint64_t bytes = 0;
  if (encoding == 1) bytes = std::uint64_t{header.point_step} * header.width * header.height;
  if (encoding == 2) {
    std::ifstream stream(file, std::ios::binary);
    std::uint32_t compressed_bytes = 0;
    stream.seekg(start);
    stream.read(reinterpret_cast<char*>(&compressed_bytes), sizeof(compressed_bytes));
    bytes = 2 * sizeof(compressed_bytes) + compressed_bytes;
  }
  if (std::filesystem::file_size(file) < start + bytes) fail(file, "ends before its last point");
}

pcl::PCLPointCloud2 read_pcl_cloud(const std::filesystem::path& file) {
  const QuietPcl quiet;
  pcl::PCLPointCloud2 cloud;
  try {
    expect_whole(file);
    if (pcl::PCDReader().read(file.string(), cloud) < 0) fail(file, "damaged or cut off");
  } catch (const PointCloudError&) {
    throw;
  } catch (const std::exception& error) {
    fail(file, std::string("damaged: ") + error.what());
  }
  if (cloud.data.size() < std::size_t{cloud.width} * cloud.height * cloud.point_step) {
    fail(file, "ends before its last point");
  }
  return cloud;
}

template <typename T>
float load(const std::uint8_t* bytes) {
  T value{};
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<float>(value);
}

using Load = float (*)(const std::uint8_t*);

Load loader(std::uint8_t datatype) {
  switch (datatype) {
    case pcl::PCLPointField::INT8:
      return load<std::int8_t>;
    case pcl::PCLPointField::UINT8:
      return load<std::uint8_t>;
    case pcl::PCLPointField::INT16:
      return load<std::int16_t>;
    case pcl::PCLPointField::UINT16:
      return load<std::uint16_t>;
    case pcl::PCLPointField::INT32:
      return load<std::int32_t>;
    case pcl::PCLPointField::UINT32:
      return load<std::uint32_t>;
    case pcl::PCLPointField::FLOAT32:
      return load<float>;
    case pcl::PCLPointField::FLOAT64:
      return load<double>;
    default:
      return nullptr;
  }
}

/// How a column of a table is read from a point's bytes.
struct Column {
  Load load = nullptr;
  std::size_t offset = 0;
};

std::vector<Column> columns_of(const pcl::PCLPointCloud2& cloud,
                               const std::filesystem::path& file,
                               const std::vector<std::string>& fields) {
  std::vector<Column> columns;
  for (const std::string& name : fields) {
    const auto field = std::ranges::find(cloud.fields, name, &pcl::PCLPointField::name);
    if (field == cloud.fields.end()) fail(file, "its points have no field '" + name + "'");
    columns.push_back({.load = loader(field->datatype), .offset = field->offset});
    if (columns.back().load == nullptr) fail(file, "field '" + name + "' is of an unknown type");
  }
  return columns;
}

PointTable read_pcd(const std::filesystem::path& file, const std::vector<std::string>& fields) {
  const pcl::PCLPointCloud2 cloud = read_pcl_cloud(file);
  const std::vector<Column> columns = columns_of(cloud, file, fields);
  PointTable table(static_cast<Eigen::Index>(std::size_t{cloud.width} * cloud.height),
                   static_cast<Eigen::Index>(columns.size()));
  const std::uint8_t* point = cloud.data.data();
  for (float* value = table.data(); value != table.data() + table.size();) {
    for (const Column& column : columns) *value++ = column.load(point + column.offset);
    point += cloud.point_step;
  }
  return table;
}

}  // namespace

PointTable read_point_fields(const std::filesystem::path& file,
                             const std::vector<std::string>& fields) {
  if (!std::filesystem::is_regular_file(file)) fail(file, "no such file");
  const std::string extension = lower_extension(file);
  if (extension == ".ply") return read_ply(file, fields);
  if (extension == ".pcd") return read_pcd(file, fields);
  fail(file, "neither a .ply nor a .pcd file");
}

std::vector<Eigen::Vector3f> read_points(const std::filesystem::path& file) {
  const PointTable table = read_point_fields(file, {"x", "y", "z"});
  std::vector<Eigen::Vector3f> points;
  points.reserve(static_cast<std::size_t>(table.rows()));
  for (const auto& row : table.rowwise()) points.emplace_back(row.transpose());
  return points;
}

void write_pcd(const std::filesystem::path& file,
               const std::vector<std::string>& fields,
               const PointTable& table) {
  assert(static_cast<Eigen::Index>(fields.size()) == table.cols());
  pcl::PCLPointCloud2 cloud;
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(table.rows());
  for (const std::string& name : fields) {
    pcl::PCLPointField field;
    field.name = name;
    field.offset = static_cast<std::uint32_t>(cloud.fields.size() * sizeof(float));
    field.datatype = pcl::PCLPointField::FLOAT32;
    field.count = 1;
    cloud.fields.push_back(field);
  }
  cloud.point_step = static_cast<std::uint32_t>(fields.size() * sizeof(float));
  cloud.row_step = cloud.point_step * cloud.width;
  cloud.data.resize(static_cast<std::size_t>(table.size()) * sizeof(float));
  std::memcpy(cloud.data.data(), table.data(), cloud.data.size());

  // Not PCDWriter::writeBinary(), which leaves unused bytes at the end of the file.
  const std::string header = pcl::PCDWriter().generateHeaderBinary(
      cloud, Eigen::Vector4f::Zero(), Eigen::Quaternionf::Identity());
  std::ofstream stream(file, std::ios::binary);
  stream << header << "DATA binary\n";
  stream.write(reinterpret_cast<const char*>(cloud.data.data()),
               static_cast<std::streamsize>(cloud.data.size()));
  stream.close();
  if (!stream) fail(file, "cannot be written");
}

void write_ply(const std::filesystem::path& file, const std::vector<Eigen::Vector3f>& points) {
  static_assert(std::endian::native == std::endian::little);
  static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float));
  std::ofstream stream(file, std::ios::binary);
  stream << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  stream.write(reinterpret_cast<const char*>(points.data()),
               static_cast<std::streamsize>(points.size() * sizeof(Eigen::Vector3f)));
  stream.close();
  if (!stream) fail(file, "cannot be written");
}

}  // namespace fleetloc
