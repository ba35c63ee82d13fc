#include "cloud/point_cloud/point_cloud_file.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>

#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::filesystem::path file_named(const std::string& name) {
  const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
  const auto folder = test_folder() / "fleetloc_pointcloud" / test->name();
  std::filesystem::create_directories(folder);
  return folder / name;
}

std::filesystem::path write(const std::string& name, const std::string& content) {
  auto file = file_named(name);
  std::ofstream(file, std::ios::binary) << content;
  return file;
}

template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const PointCloudError& error) {
    return error.what();
  }
  return "no error";
}

std::string bytes_of(float value, std::endian order) {
  auto bits = std::bit_cast<std::uint32_t>(value);
  std::string bytes(4, '\0');
  for (std::size_t i = 0; i < 4; ++i, bits >>= 8U) {
    bytes[order == std::endian::little ? i : 3 - i] = static_cast<char>(bits & 0xffU);
  }
  return bytes;
}

std::string binary_ply(std::endian order) {
  std::string text = "ply\nformat binary_";
  text += order == std::endian::little ? "little" : "big";
  text +=
      "_endian 1.0\ncomment a survey\nelement vertex 2\nproperty float x\nproperty uchar red\n"
      "property float y\nproperty float z\nend_header\n";
  for (const float base : {1.0F, -4.5F}) {
    text += bytes_of(base, order) + '\x7f' + bytes_of(base + 0.25F, order);
    text += bytes_of(base + 0.5F, order);
  }
  return text;
}

const auto kTwoPoints =
    ElementsAre(Eigen::Vector3f(1.0F, 1.25F, 1.5F), Eigen::Vector3f(-4.5F, -4.25F, -4.0F));

TEST(PointCloudFile, ReadsBinaryPlyOfBothByteOrdersAndIgnoresOtherProperties) {
  EXPECT_THAT(read_points(write("a.ply", binary_ply(std::endian::little))), kTwoPoints);
  EXPECT_THAT(read_points(write("b.PLY", binary_ply(std::endian::big))), kTwoPoints);
}

TEST(PointCloudFile, ReadsAsciiPlyWithDoublesAndFaces) {
  const auto file = write("a.ply",
                          "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\n"
                          "property double y\nproperty double z\nproperty uchar intensity\n"
                          "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
                          "1 2 3 9\n4 5 6 9\n-7 8e-1 9 9\n3 0 1 2\n");
  EXPECT_THAT(
      read_points(file),
      ElementsAre(
          Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(4, 5, 6), Eigen::Vector3f(-7.0F, 0.8F, 9.0F)));
}

TEST(PointCloudFile, ReadsAsciiPcd) {
  const auto file =
      write("a.pcd",
            "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity\nSIZE 4 4 4 4\n"
            "TYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
            "POINTS 2\nDATA ascii\n1 1.25 1.5 7\n-4.5 -4.25 -4 8\n");
  EXPECT_THAT(read_points(file), kTwoPoints);
}

TEST(PointCloudFile, ReadsPcdOfOtherTypesThatIsCompressed) {
  pcl::PCLPointCloud2 cloud;
  cloud.width = 2;
  cloud.height = 1;
  std::uint32_t offset = 0;
  for (const auto& [name, type, bytes, count] :
       {std::tuple{"id", pcl::PCLPointField::UINT8, 1U, 3U},
        {"x", pcl::PCLPointField::FLOAT64, 8U, 1U},
        {"y", pcl::PCLPointField::INT16, 2U, 1U},
        {"z", pcl::PCLPointField::FLOAT32, 4U, 1U}}) {
    cloud.fields.emplace_back();
    cloud.fields.back().name = name;
    cloud.fields.back().offset = offset;
    cloud.fields.back().datatype = static_cast<std::uint8_t>(type);
    cloud.fields.back().count = count;
    offset += bytes * count;
  }
  cloud.point_step = offset;
  cloud.row_step = 2 * offset;
  cloud.data.resize(cloud.row_step, 0);
  for (const std::uint32_t i : {0U, 1U}) {
    const double x = 1.5 + i;
    const auto y = static_cast<std::int16_t>(-7 - static_cast<int>(i));
    const float z = 0.25F;
    std::memcpy(&cloud.data[i * offset + 3], &x, 8);
    std::memcpy(&cloud.data[i * offset + 11], &y, 2);
    std::memcpy(&cloud.data[i * offset + 13], &z, 4);
  }
  const auto file = file_named("a.pcd");
  pcl::PCDWriter().writeBinaryCompressed(file.string(), cloud);
  EXPECT_THAT(
      read_points(file),
      ElementsAre(Eigen::Vector3f(1.5F, -7.0F, 0.25F), Eigen::Vector3f(2.5F, -8.0F, 0.25F)));
}

TEST(PointCloudFile, RefusesAPcdThatPromisesWhatIsNotThere) {
  const std::string head = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\n";
  const std::string many = "COUNT 1 1 1\nWIDTH 4000000000\nHEIGHT 1\nPOINTS 4000000000\n";
  const std::string one = "WIDTH 1\nHEIGHT 1\nPOINTS 1\n";
  for (const char* encoding : {"ascii", "binary", "binary_compressed"}) {
    const auto file = write("a.pcd", head + many + "DATA " + encoding + "\n12345678");
    EXPECT_THAT(error_of([&] { read_points(file); }), HasSubstr("ends before its last point"));
  }
  const std::string data = "DATA binary\n123456781234";
  EXPECT_EQ(read_points(write("a.pcd", head + "COUNT 1 1 1\n" + one + data)).size(), 1U);
  const auto no_z = write("b.pcd", head + "COUNT 1 1 0\n" + one + data);
  EXPECT_THAT(error_of([&] { read_points(no_z); }), HasSubstr("field 'z' has no valid size"));
  const auto two = write("c.pcd", head + "WIDTH 2\nHEIGHT 1\nPOINTS 1\n" + data);
  EXPECT_THAT(error_of([&] { read_points(two); }), HasSubstr("WIDTH times HEIGHT is not POINTS"));
}

TEST(PointCloudFile, DoesNotCountElementsOfPlyThatHaveNothing) {
  const auto file =
      write("a.ply", "ply\nformat ascii 1.0\nelement face 4000000000000\nend_header\n");
  EXPECT_THAT(error_of([&] { read_points(file); }), HasSubstr("holds no points"));
}

TEST(PointCloudFile, ReturnsWrittenFieldsBitByBit) {
  PointTable table = PointTable::Random(100, 7);
  table(3, 5) = -0.0F;
  const std::vector<std::string> fields = {
      "x", "y", "z", "normal_x", "normal_y", "normal_z", "planarity"};
  const auto file = file_named("map.pcd");
  write_pcd(file, fields, table);

  EXPECT_EQ(read_point_fields(file, fields), table);
  EXPECT_EQ(read_point_fields(file, {"planarity", "y"}).col(0), table.col(6));
  EXPECT_EQ(read_points(file).at(42), table.row(42).head<3>().transpose());
}

TEST(PointCloudFile, NamesTheFileThatIsMissing) {
  EXPECT_THAT(error_of([] { read_points("/nowhere/cloud.ply"); }),
              HasSubstr("/nowhere/cloud.ply: no such file"));
}

TEST(PointCloudFile, NamesTheFileOfAnUnknownKind) {
  const auto file = write("cloud.las", "LASF");
  EXPECT_THAT(error_of([&] { read_points(file); }),
              AllOf(HasSubstr(file.string()), HasSubstr("neither a .ply nor a .pcd")));
}

TEST(PointCloudFile, NamesTheMissingField) {
  const auto file = write("a.ply",
                          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                          "property float y\nend_header\n1 2\n");
  EXPECT_THAT(error_of([&] { read_points(file); }),
              AllOf(HasSubstr(file.string()), HasSubstr("no field 'z'")));
}

TEST(PointCloudFile, RefusesAFileWithoutPoints) {
  const auto file = write("a.ply",
                          "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\n"
                          "property float y\nproperty float z\nend_header\n");
  EXPECT_THAT(error_of([&] { read_points(file); }), HasSubstr(file.string()));
}

TEST(PointCloudFile, RefusesAFileThatIsCutOffAnywhere) {
  write_pcd(file_named("whole.pcd"), {"x", "y", "z"}, PointTable::Random(20, 3));
  std::ifstream stream(file_named("whole.pcd"), std::ios::binary);
  const std::string pcd{std::istreambuf_iterator<char>(stream), {}};
  const std::string ply = binary_ply(std::endian::little);
  for (std::size_t missing = 1; missing < 40; missing += 3) {
    const auto cut_ply = write("cut.ply", ply.substr(0, ply.size() - missing));
    EXPECT_THAT(error_of([&] { read_points(cut_ply); }), HasSubstr(cut_ply.string())) << missing;
    const auto cut_pcd = write("cut.pcd", pcd.substr(0, pcd.size() - missing));
    EXPECT_THAT(error_of([&] { read_points(cut_pcd); }), HasSubstr(cut_pcd.string())) << missing;
  }
}

TEST(PointCloudFile, RefusesAnAsciiPcdThatIsCutOff) {
  const auto file = write("a.pcd",
                          "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                          "WIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA ascii\n1 2 3\n");
  EXPECT_THAT(error_of([&] { read_points(file); }), HasSubstr(file.string()));
}

TEST(PointCloudFile, RefusesGarbage) {
  for (const char* name : {"a.ply", "a.pcd"}) {
    const auto file = write(name, std::string(1000, 'q'));
    EXPECT_THAT(error_of([&] { read_points(file); }), HasSubstr(file.string()));
  }
}

TEST(PointCloudFile, NamesTheFileThatCannotBeWritten) {
  EXPECT_THAT(error_of([] {
                write_pcd("/nowhere/map.pcd", {"x", "y", "z"}, PointTable::Zero(1, 3));
              }),
              HasSubstr("/nowhere/map.pcd: cannot be written"));
}

}  // namespace
}  // namespace fleetloc
