#include "test/ros2/recorded_sensors.hpp"

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>

namespace fleetloc {
namespace {

std::vector<std::vector<std::string>> lines_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be read");
  std::vector<std::vector<std::string>> lines;
  for (std::string line; std::getline(stream, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#') continue;
    std::istringstream text(line);
    std::vector<std::string>& fields = lines.emplace_back();
    for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
  }
  return lines;
}

std::map<std::int64_t, std::filesystem::path> images_of(const std::filesystem::path& camera) {
  std::map<std::int64_t, std::filesystem::path> images;
  for (const auto& line : lines_of(camera / "data.csv")) {
    images[std::stoll(line.at(0))] = camera / "data" / line.at(1);
  }
  return images;
}

RecordedImu imu_of(const std::vector<std::string>& line) {
  RecordedImu sample{.stamp_ns = std::stoll(line.at(0))};
  for (std::size_t i = 0; i < sample.values.size(); ++i) {
    sample.values[i] = std::stod(line.at(i + 1));
  }
  return sample;
}

}  // namespace

std::int64_t stamp_ns(const RecordedSample& sample) {
  return std::visit([](const auto& any) { return any.stamp_ns; }, sample);
}

std::vector<RecordedSample> recorded_sensors(const std::filesystem::path& folder,
                                             double duration_s) {
  constexpr double kPerSecond = 1e9;
  constexpr std::int64_t kImuAfterwards = 200'000'000;  // [ns]
  const auto left = images_of(folder / "mav0" / "cam0");
  const auto right = images_of(folder / "mav0" / "cam1");
  if (left.empty()) throw std::runtime_error(folder.string() + ": no images");
  const auto end = left.begin()->first + static_cast<std::int64_t>(duration_s * kPerSecond);
  std::vector<RecordedSample> samples;
  for (const auto& line : lines_of(folder / "mav0" / "imu0" / "data.csv")) {
    if (const RecordedImu sample = imu_of(line); sample.stamp_ns < end + kImuAfterwards) {
      samples.emplace_back(sample);
    }
  }
  for (const auto& [stamp, file] : left) {
    const auto other = right.find(stamp);
    if (stamp >= end || other == right.end()) continue;
    samples.emplace_back(RecordedPair{.stamp_ns = stamp, .left = file, .right = other->second});
  }
  std::ranges::stable_sort(samples, {}, [](const RecordedSample& one) { return stamp_ns(one); });
  return samples;
}

}  // namespace fleetloc
