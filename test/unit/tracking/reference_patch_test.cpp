#include "robot/tracking/reference_patch.hpp"

#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gmock/gmock.h>

#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"

namespace fleetloc {
namespace {

constexpr int kSide = 80;
const cv::Point2f kReference(40.25F, 39.5F);
const cv::Point2f kNow(37.6F, 42.3F);

ReferencePatchConfig reference_config() {
  auto reader = ConfigReader::from_string(default_config("robot"), "defaults");
  return read_reference_patch_config(reader.section("tracking").section("reference"));
}

double waves_at(const Eigen::Vector2d& p) {
  const double wave = std::sin(0.9 * p.x() + 0.4 * p.y()) + std::sin(0.7 * p.y() - 0.5 * p.x()) +
                      std::sin(0.35 * p.x() + 0.8 * p.y() + 1.0);
  return 120.0 + 30.0 * wave;
}

/// What is around `kReference` in the first image is around `center` in this one, warped.
cv::Mat seen(const cv::Point2f& center, const Eigen::Matrix2d& warp, double brighter = 0.0) {
  const Eigen::Matrix2d to_reference = warp.inverse();
  cv::Mat image(kSide, kSide, CV_8UC1);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const Eigen::Vector2d offset(x - static_cast<double>(center.x),
                                   y - static_cast<double>(center.y));
      const Eigen::Vector2d p = Eigen::Vector2d(kReference.x, kReference.y) + to_reference * offset;
      image.at<unsigned char>(y, x) = cv::saturate_cast<unsigned char>(waves_at(p) + brighter);
    }
  }
  return image;
}

ReferencePatch reference() {
  return ReferencePatch::cut(seen(kReference, Eigen::Matrix2d::Identity()),
                             kReference,
                             reference_config().radius_px)
      .value();
}

/// How far beside the truth the match is, from a start 0.7 px beside it.
double off_px(const Eigen::Matrix2d& warp,
              const Eigen::Matrix2d& predicted,
              double brighter = 0.0,
              const ReferencePatchConfig& config = reference_config()) {
  const auto pixel = reference().match(
      seen(kNow, warp, brighter), {kNow.x + 0.5F, kNow.y - 0.5F}, predicted.cast<float>(), config);
  return pixel ? cv::norm(*pixel - kNow) : 1000.0;
}

Eigen::Matrix2d turned(double zoom, double rad) {
  return zoom * Eigen::Rotation2Dd(rad).toRotationMatrix();
}

TEST(ReferencePatch, IsFoundWhereItIsWarpedAsPredicted) {
  for (const double zoom : {0.8, 1.0, 1.25}) {
    for (const double rad : {-0.4, 0.0, 0.6}) {
      EXPECT_LT(off_px(turned(zoom, rad), turned(zoom, rad)), 0.03) << zoom << " " << rad;
    }
  }
}

TEST(ReferencePatch, IsFoundWhereItIsWarpedOtherwise) {
  Eigen::Matrix2d slanted = turned(1.1, 0.2);
  slanted(0, 1) += 0.08;
  slanted(1, 1) -= 0.06;
  EXPECT_LT(off_px(slanted, turned(1.1, 0.2)), 0.05);
  EXPECT_LT(off_px(turned(1.08, 0.05), Eigen::Matrix2d::Identity()), 0.05);
}

TEST(ReferencePatch, DoesNotMindADifferenceOfBrightness) {
  EXPECT_LT(off_px(turned(1.1, 0.1), turned(1.1, 0.1), 20.0), 0.03);
}

TEST(ReferencePatch, IsNotCutAtTheBorderNorFoundThere) {
  const cv::Mat image = seen(kReference, Eigen::Matrix2d::Identity());
  const int radius = reference_config().radius_px;
  EXPECT_FALSE(ReferencePatch::cut(image, {static_cast<float>(radius), 39.5F}, radius));
  EXPECT_FALSE(reference().match(image,
                                 {static_cast<float>(kSide - radius), 39.5F},
                                 Eigen::Matrix2f::Identity(),
                                 reference_config()));
}

TEST(ReferencePatch, IsNotFoundInWhatLooksDifferent) {
  const cv::Mat blank(kSide, kSide, CV_8UC1, cv::Scalar(120));
  EXPECT_FALSE(reference().match(blank, kNow, Eigen::Matrix2f::Identity(), reference_config()));
  const cv::Mat elsewhere = seen(kNow + cv::Point2f(11.0F, -9.0F), Eigen::Matrix2d::Identity());
  EXPECT_FALSE(reference().match(elsewhere, kNow, Eigen::Matrix2f::Identity(), reference_config()));
}

TEST(ReferencePatch, WithoutTextureIsNeverFound) {
  const cv::Mat blank(kSide, kSide, CV_8UC1, cv::Scalar(120));
  const auto patch = ReferencePatch::cut(blank, kReference, 7).value();
  EXPECT_FALSE(patch.match(blank, kReference, Eigen::Matrix2f::Identity(), reference_config()));
}

TEST(ReferencePatch, IsNotLookedForWhereItIsZoomedTooMuch) {
  EXPECT_EQ(off_px(turned(1.5, 0.0), turned(1.5, 0.0)), 1000.0);
  EXPECT_EQ(off_px(turned(0.6, 0.0), turned(0.6, 0.0)), 1000.0);
}

TEST(ReferencePatch, DoesNotLeaveTheStartsNeighbourhood) {
  ReferencePatchConfig narrow = reference_config();
  narrow.max_px = 0.3;
  EXPECT_EQ(off_px(turned(1.0, 0.0), turned(1.0, 0.0), 0.0, narrow), 1000.0);
}

}  // namespace
}  // namespace fleetloc
