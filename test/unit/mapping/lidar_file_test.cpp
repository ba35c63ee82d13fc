#include "cloud/mapping/lidar_file.hpp"

#include <fstream>

#include <gmock/gmock.h>

#include "shared/dataset/sensor_file.hpp"
#include "shared/geometry/so3.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const LidarCalibration kCalibration{.T_body_lidar = {.R = exp_so3({0.1, 0.2, 0.3}), .p = {1, 2, 3}},
                                    .rate_hz = 10.0,
                                    .columns = 1800,
                                    .rings = 16};

LidarScan scan_at(int number) {
  LidarScan scan{.stamp = Timestamp(Duration(1'403'636'579'758'555'392 + 100'000'000L * number)),
                 .points = {}};
  for (int i = 0; i < 10 * number; ++i) {
    const auto x = static_cast<float>(i) + 0.1F;
    scan.points.push_back({.p_lidar = {x, -x, 0.5F},
                           .column = static_cast<std::uint16_t>(50 * i),
                           .ring = static_cast<std::uint8_t>(i % 16)});
  }
  return scan;
}

/// A folder with three scans, the first of which is empty.
std::filesystem::path written(const std::string& name) {
  auto folder = test_folder() / name;
  std::filesystem::remove_all(folder);
  LidarWriter writer(folder, kCalibration);
  for (int i = 0; i < 3; ++i) writer.add(scan_at(i));
  writer.finish();
  return folder;
}

std::filesystem::path last_scan(const std::filesystem::path& folder) {
  const std::string stamp = std::to_string(scan_at(2).stamp.time_since_epoch().count());
  return folder / "data" / (stamp + ".bin");
}

void expect_refused(const std::filesystem::path& folder, const std::string& message) {
  EXPECT_THAT(
      [&] {
        const LidarReader reader(folder);
        static_cast<void>(reader.scan(2));
      },
      ThrowsMessage<DatasetError>(AllOf(HasSubstr(folder.string()), HasSubstr(message))));
}

TEST(LidarFile, ReadsWhatWasWritten) {
  const LidarReader reader(written("lidar0"));
  EXPECT_EQ(reader.calibration().columns, kCalibration.columns);
  EXPECT_EQ(reader.calibration().rings, kCalibration.rings);
  EXPECT_EQ(reader.calibration().rate_hz, kCalibration.rate_hz);
  const Pose error = inverse(kCalibration.T_body_lidar) * reader.calibration().T_body_lidar;
  EXPECT_LT(log_se3(error).norm(), 1e-14);
  ASSERT_EQ(reader.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    const LidarScan expected = scan_at(i);
    const LidarScan scan = reader.scan(static_cast<std::size_t>(i));
    EXPECT_EQ(scan.stamp, expected.stamp);
    ASSERT_EQ(scan.points.size(), expected.points.size());
    for (std::size_t k = 0; k < scan.points.size(); ++k) {
      EXPECT_EQ(scan.points[k].p_lidar, expected.points[k].p_lidar);
      EXPECT_EQ(scan.points[k].column, expected.points[k].column);
      EXPECT_EQ(scan.points[k].ring, expected.points[k].ring);
    }
  }
}

TEST(LidarFile, NamesTheLineOfAMissingScan) {
  const auto folder = written("missing");
  std::filesystem::remove(last_scan(folder));
  expect_refused(folder, "data.csv:4: ");
}

TEST(LidarFile, NamesTheLineOfAScanThatIsCutOff) {
  const auto folder = written("cut");
  std::filesystem::resize_file(last_scan(folder), 8);
  expect_refused(folder, "cut off");
  expect_refused(folder, "data.csv:4: ");
}

TEST(LidarFile, RefusesPointsThatTheLidarCannotHaveMeasured) {
  const auto folder = written("ring");
  std::fstream stream(last_scan(folder), std::ios::binary | std::ios::in | std::ios::out);
  stream.seekp(2 * 16 + 14);  // the ring of the third point
  stream.put(16);
  stream.close();
  expect_refused(folder, "point 3 cannot have been measured");
}

TEST(LidarFile, RefusesStampsThatDoNotIncrease) {
  const auto folder = written("stamps");
  std::ofstream(folder / "data.csv", std::ios::app) << "5,5.bin\n";
  expect_refused(folder, "data.csv:5: the stamp is not later");
}

TEST(LidarFile, NamesTheKeyThatTheSensorsFileLacks) {
  const auto folder = written("sensor");
  std::ofstream(folder / "sensor.yaml") << "sensor_type: lidar\nrate_hz: 10\n";
  expect_refused(folder, "T_BS");
}

}  // namespace
}  // namespace fleetloc
