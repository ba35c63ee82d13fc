#include "test/ros2/recorded_topics.hpp"

#include "shared/config/delimited_file.hpp"

namespace fleetloc {
namespace {

double seconds_since_boot(const DelimitedFile& file, std::size_t column) {
  return to_seconds(file.nanoseconds(column) - Timestamp{});
}

}  // namespace

std::vector<RecordedPose> recorded_poses(const std::filesystem::path& path) {
  constexpr std::size_t kPose = 4;
  constexpr std::size_t kCovariance = kPose + 7;
  std::vector<RecordedPose> poses;
  DelimitedFile file(path, ',');
  while (file.next()) {
    const auto at = [&](std::size_t i) { return file.number(kPose + i); };
    RecordedPose& pose = poses.emplace_back();
    pose.received_s = seconds_since_boot(file, 0);
    pose.stamp = file.nanoseconds(1);
    pose.frame = file.text(2);
    pose.child_frame = file.text(3);
    pose.T_frame_child = {.R = Eigen::Quaterniond(at(6), at(3), at(4), at(5)),
                          .p = {at(0), at(1), at(2)}};
    if (file.columns() == kCovariance) continue;
    for (std::size_t i = 0; i < pose.covariance.size(); ++i) {
      pose.covariance[i] = file.number(kCovariance + i);
    }
  }
  return poses;
}

std::vector<RecordedImage> recorded_images(const std::filesystem::path& path) {
  constexpr std::size_t kFormat = 4;
  constexpr std::size_t kHash = 9;
  std::vector<RecordedImage> images;
  DelimitedFile file(path, ',');
  while (file.next()) {
    RecordedImage& image = images.emplace_back();
    image.stamp = file.nanoseconds(1);
    image.frame = file.text(2);
    image.topic = file.text(3);
    for (std::size_t i = kFormat; i < kHash; ++i) {
      image.format += (i == kFormat ? "" : ",") + std::string(file.text(i));
    }
    image.fnv1a = std::stoull(std::string(file.text(kHash)));
  }
  return images;
}

std::map<Timestamp, std::array<double, 6>> recorded_imu(const std::filesystem::path& path) {
  constexpr std::size_t kValues = 4;
  std::map<Timestamp, std::array<double, 6>> samples;
  DelimitedFile file(path, ',');
  while (file.next()) {
    std::array<double, 6>& values = samples[file.nanoseconds(1)];
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = file.number(kValues + i);
  }
  return samples;
}

std::map<Timestamp, double> publication_times(const std::filesystem::path& path) {
  std::map<Timestamp, double> times;
  DelimitedFile file(path, ',');
  while (file.next()) times[file.nanoseconds(0)] = seconds_since_boot(file, 1);
  return times;
}

}  // namespace fleetloc
