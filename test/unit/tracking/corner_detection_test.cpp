#include "robot/tracking/corner_detection.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "test/unit/tracking/tracking_config.hpp"

namespace fleetloc {
namespace {

/// Bright squares of 8 px on a dark ground, one every 24 px.
cv::Mat squares(int width, int height) {
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(40));
  for (int y = 12; y + 8 < height; y += 24) {
    for (int x = 12; x + 8 < width; x += 24) {
      cv::rectangle(image, cv::Rect(x, y, 8, 8), cv::Scalar(200), cv::FILLED);
    }
  }
  cv::GaussianBlur(image, image, cv::Size(3, 3), 0.7);
  return image;
}

class CornerDetectionTest : public testing::Test {
 protected:
  CornerDetectionConfig config_ = default_tracking_config().corners;
};

TEST_F(CornerDetectionTest, SpreadsOverTheWholeImage) {
  const auto corners = detect_corners(squares(752, 480), {}, config_);
  EXPECT_EQ(corners.size(), static_cast<std::size_t>(config_.features));
  std::vector<int> quadrants(4);
  for (const auto& corner : corners) {
    const std::size_t column = corner.x < 376 ? 0 : 1;
    const std::size_t row = corner.y < 240 ? 0 : 1;
    ++quadrants[column + 2 * row];
  }
  for (const int quadrant : quadrants) EXPECT_NEAR(quadrant, config_.features / 4.0, 12.0);
}

TEST_F(CornerDetectionTest, KeepsTheDistanceToOldAndNewFeatures) {
  const std::vector<cv::Point2f> present{{100.0F, 100.0F}, {300.5F, 200.5F}, {500.0F, 400.0F}};
  auto all = present;
  for (const auto& corner : detect_corners(squares(752, 480), present, config_)) {
    for (const auto& other : all) {
      EXPECT_GE(cv::norm(corner - other), config_.min_distance_px);
    }
    all.push_back(corner);
  }
  EXPECT_EQ(all.size(), static_cast<std::size_t>(config_.features));
}

TEST_F(CornerDetectionTest, FillsTheEmptySideFirst) {
  config_.features = 100;
  config_.refill_below = 100;
  std::vector<cv::Point2f> present;
  for (int y = 20; y < 470; y += 50) {
    for (int x = 20; x < 370; x += 50) present.emplace_back(x, y);
  }
  const auto corners = detect_corners(squares(752, 480), present, config_);
  const auto right = std::count_if(
      corners.begin(), corners.end(), [](const cv::Point2f& corner) { return corner.x > 368.0F; });
  EXPECT_GE(corners.size(), 25U);
  EXPECT_GE(static_cast<double>(right), 0.9 * static_cast<double>(corners.size()));
}

TEST_F(CornerDetectionTest, DoesNothingWhileThereAreEnough) {
  std::vector<cv::Point2f> present(static_cast<std::size_t>(config_.refill_below));
  EXPECT_TRUE(detect_corners(squares(752, 480), present, config_).empty());
}

TEST_F(CornerDetectionTest, FindsNothingInNoiseOrOnAnEdge) {
  cv::Mat noise(480, 752, CV_8UC1);
  cv::RNG(1).fill(noise, cv::RNG::NORMAL, 100.0, 3.0);
  EXPECT_TRUE(detect_corners(noise, {}, config_).empty());
  cv::Mat edge(480, 752, CV_8UC1, cv::Scalar(50));
  edge.colRange(300, 752).setTo(200);
  EXPECT_TRUE(detect_corners(edge, {}, config_).empty());
}

TEST_F(CornerDetectionTest, TakesImagesSmallerThanTheGrid) {
  EXPECT_TRUE(detect_corners(squares(12, 6), {}, config_).empty());
}

}  // namespace
}  // namespace fleetloc
