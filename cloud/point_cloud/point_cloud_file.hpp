#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace fleetloc {

/// A point cloud file that cannot be read or written. The message names the file and the reason.
class PointCloudError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// One row per point, one column per field.
using PointTable = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Reads the named fields of every point of a .ply (ASCII or binary of either byte order) or .pcd
/// file (ASCII, binary or compressed). Other fields are ignored; points that are not finite are
/// kept. Throws PointCloudError, also where a field is missing or the file ends early.
/// @return  as many columns as `fields`, in their order; at least one row
PointTable read_point_fields(const std::filesystem::path& file,
                             const std::vector<std::string>& fields);

/// Positions of all points of the file [m]: its fields x, y and z.
std::vector<Eigen::Vector3f> read_points(const std::filesystem::path& file);

/// Writes a binary .pcd file of float fields. Throws PointCloudError.
/// @param table  as many columns as `fields`
void write_pcd(const std::filesystem::path& file,
               const std::vector<std::string>& fields,
               const PointTable& table);

/// Writes positions [m] to a binary .ply file. Throws PointCloudError.
void write_ply(const std::filesystem::path& file, const std::vector<Eigen::Vector3f>& points);

}  // namespace fleetloc
