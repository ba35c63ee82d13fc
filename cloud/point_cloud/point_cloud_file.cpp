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

#include "cloud/point_cloud/pcd_file.hpp"
#include "cloud/point_cloud/ply_file.hpp"

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
