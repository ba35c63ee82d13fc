#include "robot/odometry/front_end.hpp"

#include <algorithm>
#include <iterator>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "shared/config/config_reader.hpp"
#include "test/simulated_setup.hpp"

namespace fleetloc {
namespace {

class FrontEndTest : public testing::Test {
 protected:
  TrackedFrame track(cv::Mat left, cv::Mat right) {
    stamp_ += std::chrono::milliseconds(50);
    return front_end_.track(
        StereoFrame{.stamp = stamp_, .left = std::move(left), .right = std::move(right)}, {}, {});
  }
  std::uint64_t count(const std::string& kind) { return front_end_.faults().at(kind); }

  const SimulatedRun run_{SimulatedRun::Config{}};
  FrontEnd front_end_{ideal_cameras(run_.stereo()),
                      run_.noise(),
                      read_feature_tracker_config(defaults().section("tracking"))};
  const cv::Mat image_ = cv::Mat::zeros(480, 752, CV_8UC1);
  Timestamp stamp_;
};

TEST_F(FrontEndTest, IgnoresAndCountsImagesThatAreMissingOrNotOfTheCalibratedKind) {
  EXPECT_FALSE(front_end_.last_stamp().has_value());
  track(image_, image_);
  EXPECT_EQ(count("missing_images"), 0U);
  track(image_, cv::Mat());
  track(cv::Mat(), cv::Mat());
  EXPECT_EQ(count("missing_images"), 3U);
  EXPECT_EQ(count("wrong_images"), 0U);
  track(cv::Mat::zeros(240, 752, CV_8UC1), cv::Mat::zeros(480, 752, CV_16UC1));
  EXPECT_EQ(count("wrong_images"), 2U);
  EXPECT_EQ(front_end_.last_stamp(), stamp_);
}

TEST_F(FrontEndTest, PassesTracksOnAsTheyAre) {
  const TrackedFrame frame = run_.frame(3);
  const TrackedFrame passed = front_end_.track(frame, {}, {});
  ASSERT_EQ(passed.observations.size(), frame.observations.size());
  EXPECT_EQ(passed.stamp, frame.stamp);
  EXPECT_EQ(front_end_.last_stamp(), frame.stamp);
}

// As while the robot stands: the dark that was looked at is forgotten, the features are the same.
TEST_F(FrontEndTest, ChangesNothingWhenItPeeks) {
  cv::Mat texture(480, 752, CV_8UC1);
  cv::RNG(1).fill(texture, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(texture, texture, {9, 9}, 2.0);
  cv::normalize(texture, texture, 0, 255, cv::NORM_MINMAX);
  const TrackedFrame before = track(texture, texture);
  ASSERT_GT(before.observations.size(), 50U);
  const auto peek = [&](const cv::Mat& image) {
    return front_end_.peek(StereoFrame{.stamp = stamp_, .left = image, .right = image});
  };
  const auto common = [&](const TrackedFrame& frame) {
    return std::ranges::count_if(frame.observations, [&](const StereoObservation& seen) {
      return std::ranges::any_of(before.observations, [&](const StereoObservation& old) {
        return old.landmark == seen.landmark && (old.left - seen.left).norm() < 0.1;
      });
    });
  };
  const auto all = std::ssize(before.observations);
  EXPECT_GT(common(peek(texture)), 9 * all / 10);
  EXPECT_EQ(common(peek(image_)), 0);
  EXPECT_EQ(common(peek(cv::Mat())), 0);
  EXPECT_GT(common(peek(texture)), 9 * all / 10);
  EXPECT_EQ(front_end_.last_stamp(), before.stamp);
  EXPECT_EQ(count("missing_images"), 0U);
  EXPECT_GT(common(track(texture, texture)), 9 * all / 10);
}

}  // namespace
}  // namespace fleetloc
