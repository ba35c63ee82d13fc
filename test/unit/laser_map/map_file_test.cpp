#include "cloud/laser_map/map_file.hpp"

#include <fstream>
#include <iterator>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud/laser_map/map_hash.hpp"
#include "cloud/point_cloud/point_cloud_file.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

LaserMap small_map() {
  std::vector<MapPoint> points;
  points.reserve(50);
  for (int i = 0; i < 50; ++i) {
    points.push_back({.p_map = Eigen::Vector3f::Random(),
                      .normal = Eigen::Vector3f::Random().normalized(),
                      .planarity = 0.02F * static_cast<float>(i)});
  }
  MapInfo info{.frame = "room \"7\"",
               .resolution_m = 0.05,
               .min = {-1.0, -0.1, 1.0 / 3.0},
               .max = {1.0, 1.0, 2.0},
               .hash = map_hash(points)};
  return {std::move(points), info};
}

/// A folder of its own for each test, with the small map in it.
class MapFile : public ::testing::Test {
 protected:
  MapFile() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    save_map(small_map(), pcd_);
  }

  static std::string read(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  static void write(const std::filesystem::path& file, const std::string& content) {
    std::ofstream(file, std::ios::binary) << content;
  }
  [[nodiscard]] std::string load_error() const {
    try {
      load_map(pcd_);
    } catch (const MapFileError& error) {
      return error.what();
    }
    return "no error";
  }

  const std::filesystem::path folder_ =
      test_folder() / "fleetloc_laser_map" /
      ::testing::UnitTest::GetInstance()->current_test_info()->name();
  const std::filesystem::path pcd_ = folder_ / "map.pcd";
  const std::filesystem::path yaml_ = folder_ / "map.yaml";
};

TEST_F(MapFile, ReturnsWhatWasSaved) {
  const LaserMap saved = small_map();
  save_map(saved, pcd_);
  const LaserMap loaded = load_map(pcd_);
  ASSERT_EQ(loaded.size(), saved.size());
  for (std::size_t i = 0; i < saved.size(); ++i) {
    EXPECT_EQ(loaded.point(i).p_map, saved.point(i).p_map);
    EXPECT_EQ(loaded.point(i).normal, saved.point(i).normal);
    EXPECT_EQ(loaded.point(i).planarity, saved.point(i).planarity);
  }
  EXPECT_EQ(loaded.info().frame, saved.info().frame);
  EXPECT_EQ(loaded.info().resolution_m, saved.info().resolution_m);
  EXPECT_EQ(loaded.info().min, saved.info().min);
  EXPECT_EQ(loaded.info().max, saved.info().max);
  EXPECT_EQ(loaded.info().hash, saved.info().hash);
}

TEST_F(MapFile, NamesAMissingMap) {
  std::filesystem::remove(pcd_);
  EXPECT_EQ(load_error(), pcd_.string() + ": no such map");
}

TEST_F(MapFile, NamesAMissingInfoFile) {
  std::filesystem::remove(yaml_);
  EXPECT_THAT(load_error(), HasSubstr(yaml_.string() + ": missing"));
}

TEST_F(MapFile, RefusesAMapThatIsCutOff) {
  const std::string pcd = read(pcd_);
  write(pcd_, pcd.substr(0, pcd.size() - 10));
  EXPECT_THAT(load_error(), HasSubstr(pcd_.string() + ": ends before its last point"));
}

TEST_F(MapFile, RefusesAMapInWhichABitHasChanged) {
  std::string pcd = read(pcd_);
  pcd[pcd.size() - 20] = static_cast<char>(pcd[pcd.size() - 20] ^ 1);
  write(pcd_, pcd);
  EXPECT_THAT(load_error(), AllOf(HasSubstr(pcd_.string()), HasSubstr("content hash")));
}

TEST_F(MapFile, RefusesPointsOfAnotherNumber) {
  write_pcd(pcd_,
            {"x", "y", "z", "normal_x", "normal_y", "normal_z", "planarity"},
            PointTable::Zero(3, 7));
  EXPECT_THAT(load_error(), HasSubstr("holds 3 points instead of 50"));
}

TEST_F(MapFile, NamesAMissingField) {
  write_pcd(pcd_, {"x", "y", "z"}, PointTable::Zero(50, 3));
  EXPECT_THAT(load_error(), AllOf(HasSubstr(pcd_.string()), HasSubstr("no field 'normal_x'")));
}

TEST_F(MapFile, NamesFileAndLineOfAWrongInfo) {
  write(yaml_, "frame: room\nresolution_m: -1\n");
  EXPECT_THAT(load_error(), HasSubstr(yaml_.string() + ":2: resolution_m: must be positive"));
  write(yaml_, "frame: room\n");
  EXPECT_THAT(load_error(), HasSubstr("resolution_m: missing"));
}

TEST_F(MapFile, NamesAFileThatCannotBeWritten) {
  EXPECT_THROW(save_map(small_map(), "/nowhere/map.pcd"), MapFileError);
}

}  // namespace
}  // namespace fleetloc
