#include <pcl/io/pcd_io.h>
#include <pcl/point_types.h>

#include "cloud/laser_map/map_file.hpp"
#include "cloud/laser_map/map_hash.hpp"
#include "cloud/locate/pyramid_file.hpp"
#include "cloud/point_cloud/point_cloud_file.hpp"
#include "test/fuzz/seeds.hpp"
#include "test/test_folder.hpp"
#include "test/unit/locate/street_map.hpp"

namespace fleetloc {
namespace {

const std::vector<Eigen::Vector3f> kPoints{{1.0F, 2.0F, 3.0F}, {-4.5F, 5.0F, 6.0F}};

void add_ply(const SeedFolder& seeds) {
  const auto file = test_folder() / "cloud.ply";
  write_ply(file, kPoints);
  seeds.add("file_ply", "binary", content_of(file));
  seeds.add("file_ply",
            "ascii",
            "ply\nformat ascii 1.0\ncomment a survey\nelement face 1\n"
            "property list uchar int vertex_indices\nelement vertex 2\nproperty double x\n"
            "property float y\nproperty float z\nproperty uchar red\nend_header\n"
            "3 0 1 2\n1 2 3 9\n4 5 -6e1 9\n");
  seeds.add("file_ply",
            "big_endian",
            joined({"ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty short x\n"
                    "property int y\nproperty list uint8 ushort more\nproperty char z\n"
                    "end_header\nabcdef",
                    "g"}));
}

void add_pcd(const SeedFolder& seeds) {
  const auto file = test_folder() / "cloud.pcd";
  PointTable table(2, 3);
  table << 1.0F, 2.0F, 3.0F, -4.5F, 5.0F, 6.0F;
  write_pcd(file, {"x", "y", "z"}, table);
  seeds.add("file_pcd", "binary", content_of(file));
  pcl::PointCloud<pcl::PointXYZI> cloud;
  for (const Eigen::Vector3f& p : kPoints) {
    pcl::PointXYZI point;
    point.getVector3fMap() = p;
    cloud.push_back(point);
  }
  pcl::PCDWriter writer;
  writer.writeBinaryCompressed(file.string(), cloud);
  seeds.add("file_pcd", "compressed", content_of(file));
  writer.writeASCII(file.string(), cloud);
  seeds.add("file_pcd", "ascii", content_of(file));
}

void add_map(const SeedFolder& seeds) {
  std::vector<MapPoint> points;
  for (const Eigen::Vector3f& p : kPoints) {
    points.push_back({.p_map = p, .normal = Eigen::Vector3f::UnitZ(), .planarity = 0.5F});
  }
  MapInfo info{.frame = "map", .resolution_m = 0.25, .hash = map_hash(points)};
  const auto file = test_folder() / "map.pcd";
  save_map(LaserMap(std::move(points), std::move(info)), file);
  seeds.add("file_map", "two_points", joined({content_of(map_info_file(file)), content_of(file)}));
}

void add_pyramid(const SeedFolder& seeds) {
  constexpr MapPyramid::Config kConfig{.cell_m = 0.5, .levels = 4, .level_from = 0.9};
  const auto file = test_folder() / "map.pyramid";
  save_pyramid(MapPyramid(StreetMap(3, 2, 6.0, 4.0).map(), kConfig), kConfig, {1, 2, 3}, file);
  std::string content = content_of(file);
  content.resize(content.size() - sizeof(std::uint64_t));  // the target adds the checksum
  seeds.add("file_pyramid", "street", content);
}

}  // namespace

void add_map_seeds(const SeedFolder& seeds) {
  add_ply(seeds);
  add_pcd(seeds);
  add_map(seeds);
  add_pyramid(seeds);
  seeds.add("file_regions",
            "all_kinds",
            "hall: {rectangle: [0, -2.5, 10, 4]}\n"
            "yard: {circle: [3, 4, 12.5], heights: [-1, 2]}\ncellar: {heights: [-6, -3]}\n");
}

}  // namespace fleetloc
