// What fleetloc-play publishes, seen by a node of ROS 2 on Eclipse Cyclone DDS.
#include <array>
#include <map>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "robot/dataset/dataset_reader.hpp"
#include "test/ros2/cyclone_fixture.hpp"
#include "test/ros2/recorded_topics.hpp"

namespace fleetloc {
namespace {

constexpr const char* kDuration_s = "3";

std::uint64_t fnv1a(const cv::Mat& image) {
  std::uint64_t hash = 14695981039346656037U;
  for (std::size_t i = 0; i < image.total(); ++i) hash = (hash ^ image.data[i]) * 1099511628211U;
  return hash;
}

std::string format(const cv::Mat& image) {
  const std::string width = std::to_string(image.cols);
  return width + ',' + std::to_string(image.rows) + ',' + width + ",mono8," +
         std::to_string(image.total());
}

using Key = std::pair<Timestamp, std::string>;  ///< stamp and topic

/// What is published of a recording: a line for each image, as the recorder writes it.
struct Expected {
  std::map<Key, std::string> images;
  std::map<Timestamp, std::array<double, 6>> imu;
};

Expected expected_of(const std::filesystem::path& folder) {
  DatasetReader recording({.folder = folder, .duration_s = std::stod(kDuration_s)});
  Expected expected;
  while (auto measurement = recording.next()) {
    if (const auto* sample = std::get_if<ImuSample>(&*measurement)) {
      const auto& w = sample->angular_velocity;
      const auto& f = sample->specific_force;
      expected.imu[sample->stamp] = {w.x(), w.y(), w.z(), f.x(), f.y(), f.z()};
      continue;
    }
    const auto& pair = std::get<StereoFrame>(std::get<CameraFrame>(*measurement));
    const auto add = [&](const char* topic, const std::string& camera, const cv::Mat& image) {
      expected.images[{pair.stamp, topic}] =
          camera + ' ' + format(image) + ' ' + std::to_string(fnv1a(image));
    };
    add("/camera/left/image_raw", "cam0", pair.left);
    add("/camera/right/image_raw", "cam1", pair.right);
  }
  return expected;
}

// Its first messages come while the viewer still learns of the publisher: from the first one on
// that was heard, nothing is missing.
template <typename Messages>
void expect_all_but_the_first(const Messages& heard, const Messages& published) {
  ASSERT_GE(heard.size(), published.size() * 9 / 10);
  const auto first = published.find(heard.begin()->first);
  ASSERT_NE(first, published.end());
  EXPECT_EQ(heard, Messages(first, published.end()));
}

class CycloneViewer : public CycloneFixture {};

TEST_F(CycloneViewer, GetsEveryMessageThatIsPlayedBitByBit) {
  if (kSanitized) GTEST_SKIP() << "sanitizers are too slow for real time";
  describe_sensors("default");
  ChildProgram viewer(CYCLONE_RECORDER, {ros_domain(), folder_of("heard").string(), "reliable"});
  const Outcome played = run(FLEETLOC_PLAY,
                             {flight_.folder.string(),
                              "--sensors",
                              sensors_.string(),
                              "--duration",
                              kDuration_s,
                              "--wait",
                              "60"});
  EXPECT_EQ(played.exit_code, 0) << played.errors;
  const Outcome recorded = ended(viewer);
  EXPECT_EQ(recorded.exit_code, 0) << recorded.errors;
  std::map<Key, std::string> images;
  for (const RecordedImage& image : recorded_images(folder_of("heard") / "images.csv")) {
    images[{image.stamp, image.topic}] =
        image.frame + ' ' + image.format + ' ' + std::to_string(image.fnv1a);
  }
  const Expected expected = expected_of(flight_.folder);
  expect_all_but_the_first(images, expected.images);
  expect_all_but_the_first(recorded_imu(folder_of("heard") / "imu.csv"), expected.imu);
}

}  // namespace
}  // namespace fleetloc
