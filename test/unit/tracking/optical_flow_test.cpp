#include "robot/tracking/optical_flow.hpp"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "test/unit/tracking/tracking_config.hpp"

namespace fleetloc {
namespace {

cv::Mat texture(std::uint64_t seed) {
  cv::Mat noise(240, 320, CV_32F);
  cv::RNG(seed).fill(noise, cv::RNG::UNIFORM, 0.0, 255.0);
  cv::GaussianBlur(noise, noise, cv::Size(0, 0), 2.0);
  cv::normalize(noise, noise, 20.0, 235.0, cv::NORM_MINMAX);
  return noise;
}

cv::Mat shifted(const cv::Mat& image, const cv::Point2f& shift) {
  const cv::Matx23f warp(1.0F, 0.0F, shift.x, 0.0F, 1.0F, shift.y);
  cv::Mat result;
  cv::warpAffine(image, result, warp, image.size(), cv::INTER_CUBIC, cv::BORDER_REFLECT);
  return result;
}

ImagePyramid pyramid(const cv::Mat& image, const OpticalFlowConfig& config) {
  cv::Mat gray;
  image.convertTo(gray, CV_8U);
  return {gray, config};
}

class OpticalFlowTest : public testing::Test {
 protected:
  OpticalFlowTest() {
    for (int y = 40; y <= 200; y += 20) {
      for (int x = 40; x <= 280; x += 20) points_.emplace_back(x, y);
    }
  }
  OpticalFlowConfig config_ = default_tracking_config().flow;
  std::vector<cv::Point2f> points_;
};

TEST_F(OpticalFlowTest, FindsAShiftToAFewHundredthsOfAPixel) {
  const cv::Point2f shift(6.3F, -3.6F);
  const auto from = pyramid(texture(1), config_);
  const auto to = pyramid(shifted(texture(1), shift), config_);
  const auto moved = track_points(from, to, points_, points_, config_);
  std::size_t found = 0;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!moved[i]) continue;
    ++found;
    EXPECT_LT(cv::norm(*moved[i] - points_[i] - shift), 0.15);
  }
  EXPECT_GT(found, points_.size() * 8 / 10);
}

TEST_F(OpticalFlowTest, LosesPointsThatAreNotThere) {
  const auto from = pyramid(texture(1), config_);
  const auto to = pyramid(texture(2), config_);
  const auto moved = track_points(from, to, points_, points_, config_);
  const auto found = std::count_if(
      moved.begin(), moved.end(), [](const auto& point) { return point.has_value(); });
  EXPECT_LT(found, static_cast<std::ptrdiff_t>(points_.size() / 5));
}

TEST_F(OpticalFlowTest, LosesPointsInABlackImage) {
  const auto from = pyramid(texture(1), config_);
  const auto to = pyramid(cv::Mat::zeros(240, 320, CV_32F), config_);
  for (const auto& point : track_points(from, to, points_, points_, config_)) {
    EXPECT_FALSE(point);
  }
}

TEST_F(OpticalFlowTest, TakesNoPoints) {
  const auto image = pyramid(texture(1), config_);
  EXPECT_TRUE(track_points(image, image, {}, {}, config_).empty());
}

}  // namespace
}  // namespace fleetloc
