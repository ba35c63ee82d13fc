#include "robot/tracking/slanted_patch.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

constexpr int kSize = 80;
const cv::Point2f kPoint(40.25F, 39.5F);
constexpr float kShift = -6.3F;

SlantedPatchConfig config() {
  auto reader = ConfigReader::from_string(default_config("everything"), "defaults");
  return read_slanted_patch_config(reader.section("tracking").section("slanted"));
}

/// Stronger below than above, as on ground that comes nearer.
double texture_at(double x, double y) {
  const double wave = std::sin(0.9 * x + 0.4 * y) + std::sin(0.7 * y - 0.5 * x) +
                      std::sin(0.35 * x + 1.1 * y + 1.0);
  return 120.0 + (0.1 * y + 16.0) * wave;
}

/// What the texture looks like where a pixel at `kPoint` is shifted by `kShift` and pixels below it
/// by `slope` more each row.
cv::Mat image(double shift, double slope, double brighter = 0.0) {
  cv::Mat image(kSize, kSize, CV_8UC1);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double moved = x - shift - slope * (y - static_cast<double>(kPoint.y));
      image.at<unsigned char>(y, x) =
          cv::saturate_cast<unsigned char>(texture_at(moved, y) + brighter);
    }
  }
  return image;
}

/// How far beside the truth the match is, from a start 0.6 px beside it.
double error_px(double slope, double slope_sigma, double brighter = 0.0) {
  const SearchLine line{.start = {kPoint.x + kShift + 0.6F, kPoint.y},
                        .direction = Eigen::Vector2f::UnitX(),
                        .slope_sigma = slope_sigma};
  const auto match = match_slanted(
      image(0.0, 0.0), image(static_cast<double>(kShift), slope, brighter), kPoint, line, config());
  if (!match) return 1000.0;
  EXPECT_EQ(match->pixel.y, kPoint.y);
  return static_cast<double>(match->pixel.x - kPoint.x - kShift);
}

TEST(SlantedPatch, FindsTheMiddleOfAShearedPatch) {
  for (const double slope : {0.0, 0.15, 0.3, -0.3}) {
    EXPECT_LT(std::abs(error_px(slope, 0.3)), 0.03) << slope;
  }
}

TEST(SlantedPatch, IsBesideTheMiddleIfItMustNotSlant) {
  EXPECT_GT(std::abs(error_px(0.3, 1e-4)), 0.1);
}

TEST(SlantedPatch, DoesNotMindADifferenceOfBrightness) {
  EXPECT_LT(std::abs(error_px(0.15, 0.3, 12.0)), 0.03);
}

TEST(SlantedPatch, GivesUpAtTheBorderAndWithoutTexture) {
  const SearchLine line{
      .start = {30.0F, 39.5F}, .direction = Eigen::Vector2f::UnitX(), .slope_sigma = 0.3};
  const cv::Mat textured = image(0.0, 0.0);
  EXPECT_FALSE(match_slanted(textured, textured, {3.0F, 39.5F}, line, config()));
  SearchLine outside = line;
  outside.start.x = 77.0F;
  EXPECT_FALSE(match_slanted(textured, textured, kPoint, outside, config()));
  const cv::Mat blank(kSize, kSize, CV_8UC1, cv::Scalar(90));
  EXPECT_FALSE(match_slanted(blank, blank, kPoint, line, config()));
}

TEST(SlantedPatch, DoesNotLeaveTheStartsNeighbourhood) {
  SlantedPatchConfig narrow = config();
  narrow.max_px = 0.3;
  const SearchLine line{.start = {kPoint.x + 0.6F, kPoint.y},
                        .direction = Eigen::Vector2f::UnitX(),
                        .slope_sigma = 0.3};
  const cv::Mat same = image(0.0, 0.0);
  EXPECT_TRUE(match_slanted(same, same, kPoint, line, config()));
  EXPECT_FALSE(match_slanted(same, same, kPoint, line, narrow));
}

}  // namespace
}  // namespace fleetloc
