#include "cloud/mapping/lidar_file.hpp"

#include <bit>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <system_error>
#include <utility>

#include "shared/config/delimited_file.hpp"
#include "shared/dataset/sensor_file.hpp"

namespace fleetloc {
namespace {

static_assert(std::endian::native == std::endian::little);

/// A point as it lies in the file.
struct Row {
  float x = 0.0F;
  float y = 0.0F;
  float z = 0.0F;
  std::uint16_t column = 0;
  std::uint8_t ring = 0;
  std::uint8_t zero = 0;
};
static_assert(sizeof(Row) == 16);

std::ofstream open(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  if (!stream) throw DatasetError(file.string() + ": cannot be written");
  return stream;
}

std::filesystem::path created(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder / "data", error);
  if (error) throw DatasetError(folder.string() + ": " + error.message());
  return folder;
}

LidarPoint point_of(const Row& row) {
  return {.p_lidar = {row.x, row.y, row.z}, .column = row.column, .ring = row.ring};
}

bool is_possible(const LidarPoint& point, const LidarCalibration& calibration) {
  return point.p_lidar.allFinite() && point.column < calibration.columns &&
         point.ring < calibration.rings;
}

}  // namespace

LidarWriter::LidarWriter(const std::filesystem::path& folder, const LidarCalibration& calibration)
    : folder_(created(folder)) {
  open(folder / "sensor.yaml", lidar_file_text(calibration));
  csv_ = open(folder / "data.csv", "#timestamp [ns],filename\n");
}

void LidarWriter::add(const LidarScan& scan) {
  std::vector<Row> rows;
  rows.reserve(scan.points.size());
  for (const LidarPoint& point : scan.points) {
    const Eigen::Vector3f& p = point.p_lidar;
    rows.push_back({p.x(), p.y(), p.z(), point.column, point.ring, 0});
  }
  std::string bytes(rows.size() * sizeof(Row), '\0');
  if (!rows.empty()) std::memcpy(bytes.data(), rows.data(), bytes.size());
  const std::string stamp = std::to_string(scan.stamp.time_since_epoch().count());
  const auto file = folder_ / "data" / (stamp + ".bin");
  std::ofstream stream = open(file, bytes);
  stream.close();
  if (!stream) throw DatasetError(file.string() + ": could not be written completely");
  csv_ << stamp << ',' << stamp << ".bin\n";
}

void LidarWriter::finish() {
  csv_.close();
  if (!csv_) throw DatasetError(folder_.string() + ": could not be written completely");
}

LidarReader::LidarReader(const std::filesystem::path& folder)
    : calibration_(read_lidar_file(folder / "sensor.yaml")) {
  try {
    DelimitedFile csv(folder / "data.csv", ',');
    while (csv.next()) {
      csv.expect_columns(2);
      const Timestamp stamp = csv.nanoseconds(0);
      if (!entries_.empty() && stamp <= entries_.back().stamp) {
        csv.fail("the stamp is not later than the one before");
      }
      auto file = folder / "data" / csv.text(1);
      if (!std::filesystem::is_regular_file(file)) csv.fail(file.string() + ": no such scan");
      entries_.push_back({.stamp = stamp,
                          .file = std::move(file),
                          .where = csv.file().string() + ":" + std::to_string(csv.line())});
    }
  } catch (const TextFileError& error) {
    throw DatasetError(error.what());
  }
}

LidarScan LidarReader::scan(std::size_t index) const {
  const Entry& entry = entries_.at(index);
  const auto fail = [&entry](const std::string& message) {
    throw DatasetError(entry.where + ": " + entry.file.string() + ": " + message);
  };
  std::ifstream stream(entry.file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) fail("cannot be read");
  if (bytes.size() % sizeof(Row) != 0) fail("the last point is cut off");
  LidarScan scan{.stamp = entry.stamp, .points = {}};
  scan.points.reserve(bytes.size() / sizeof(Row));
  for (std::size_t at = 0; at < bytes.size(); at += sizeof(Row)) {
    Row row;
    std::memcpy(&row, bytes.data() + at, sizeof(Row));
    scan.points.push_back(point_of(row));
    if (!is_possible(scan.points.back(), calibration_)) {
      fail("point " + std::to_string(scan.points.size()) + " cannot have been measured");
    }
  }
  return scan;
}

}  // namespace fleetloc
