#include "robot/tracking/feature_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "shared/geometry/so3.hpp"
#include "test/unit/tracking/textured_scene.hpp"
#include "test/unit/tracking/tracking_config.hpp"

namespace fleetloc {
namespace {

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.at(values.size() / 2);
}

class FeatureTrackerTest : public testing::Test {
 protected:
  static void SetUpTestSuite() { cv::setNumThreads(1); }

  /// A hand-held camera: some centimeters and degrees per frame.
  static Pose moving(int frame) {
    const double t = 0.2 * frame;
    return {.R = exp_so3({0.05 * std::sin(t), 0.08 * std::sin(0.7 * t), 0.1 * t}),
            .p = {0.3 * std::sin(t), 0.2 * (1.0 - std::cos(t)), 0.1 * t}};
  }

  /// Pure rotation, and fast: 2.9 degrees per frame.
  static Pose turning(int frame) {
    return {.R = exp_so3({0.0, 0.05 * frame, 0.0}), .p = {0, 0, 0}};
  }

  static Eigen::Quaterniond rotation(const Pose& from, const Pose& to) {
    return from.R.conjugate() * to.R;
  }

  static const TexturedScene& scene() {
    static const TexturedScene instance;
    return instance;
  }

  static std::size_t common(const TrackedFrame& a, const TrackedFrame& b) {
    return static_cast<std::size_t>(std::count_if(
        a.observations.begin(), a.observations.end(), [&](const StereoObservation& observation) {
          return std::any_of(b.observations.begin(), b.observations.end(), [&](const auto& other) {
            return other.landmark == observation.landmark;
          });
        }));
  }

  FeatureTracker tracker_{scene().calibration(), default_tracking_config()};
};

TEST_F(FeatureTrackerTest, FollowsAWallBelowATenthOfAPixel) {
  std::map<LandmarkId, Eigen::Vector2d> last;
  std::vector<double> flow_errors;
  std::vector<double> disparity_errors;
  for (int i = 0; i < 12; ++i) {
    const Pose T = moving(i);
    const Pose T_last = moving(i - 1);
    const auto frame = tracker_.track(scene().render(T), rotation(T_last, T));
    EXPECT_GT(frame.observations.size(), 50U);
    std::map<LandmarkId, Eigen::Vector2d> now;
    for (const auto& o : frame.observations) {
      now[o.landmark] = o.left;
      if (o.disparity > 0.0) {
        const auto truth = scene().project_point(T, scene().wall_point(T, o.left));
        disparity_errors.push_back(std::abs(truth[0] - truth[2] - o.disparity));
      }
      if (!last.contains(o.landmark)) continue;
      const auto truth = scene().project_point(T, scene().wall_point(T_last, last[o.landmark]));
      flow_errors.push_back((truth.head<2>() - o.left).norm());
    }
    last = now;
  }
  EXPECT_GT(flow_errors.size(), 500U);
  EXPECT_LT(median(flow_errors), 0.1);
  EXPECT_GT(disparity_errors.size(), 500U);
  EXPECT_LT(median(disparity_errors), 0.1);
}

// Each step's errors are those of noisy images; matched with the image before, they would add up.
TEST_F(FeatureTrackerTest, DoesNotDriftFromWhatItFirstSaw) {
  constexpr int kFrames = 20;
  cv::RNG random(1);
  std::map<LandmarkId, Eigen::Vector3d> first;
  std::vector<double> early;
  std::vector<double> late;
  for (int i = 0; i < kFrames; ++i) {
    const Pose T = moving(i);
    auto images = scene().render(T);
    for (cv::Mat* image : {&images.left, &images.right}) {
      cv::Mat noise(image->size(), CV_16S);
      random.fill(noise, cv::RNG::NORMAL, 0.0, 5.0);
      cv::add(*image, noise, *image, cv::noArray(), CV_8U);
    }
    const auto frame = tracker_.track(images, rotation(moving(i - 1), T));
    for (const auto& o : frame.observations) {
      const auto seen = first.emplace(o.landmark, scene().wall_point(T, o.left));
      const double error = (scene().project_point(T, seen.first->second).head<2>() - o.left).norm();
      if (i == 2 && !seen.second) early.push_back(error);
      if (i == kFrames - 1 && static_cast<std::uint32_t>(o.landmark) < 60U) late.push_back(error);
    }
  }
  ASSERT_GT(late.size(), 10U);
  std::cout << "median error " << median(early) << " px after 2 frames, " << median(late)
            << " px of " << late.size() << " after " << kFrames - 1 << "\n";
  EXPECT_LT(median(late), 1.5 * median(early));
}

TEST_F(FeatureTrackerTest, KeepsFeaturesAsLongAsTheyAreInView) {
  const auto first = tracker_.track(scene().render(moving(0)), Eigen::Quaterniond::Identity());
  TrackedFrame frame;
  for (int i = 1; i < 10; ++i) {
    frame = tracker_.track(scene().render(moving(i)), rotation(moving(i - 1), moving(i)));
  }
  std::size_t in_view = 0;
  for (const auto& o : first.observations) {
    const auto p = scene().wall_point(moving(0), o.left);
    const Pose T_world_cam = moving(9) * scene().calibration().T_body_cam0;
    const auto pixel = project(scene().calibration().cam0, inverse(T_world_cam) * p).value();
    if (pixel.x() > 12 && pixel.x() < 364 && pixel.y() > 12 && pixel.y() < 228) ++in_view;
  }
  EXPECT_GT(in_view, 30U);
  EXPECT_GE(common(first, frame), in_view * 85 / 100);
}

TEST_F(FeatureTrackerTest, FindsADisparityForAlmostAllFeatures) {
  const auto frame = tracker_.track(scene().render(moving(0)), Eigen::Quaterniond::Identity());
  const auto with = std::count_if(frame.observations.begin(),
                                  frame.observations.end(),
                                  [](const auto& o) { return o.disparity > 0.0; });
  EXPECT_EQ(with, tracker_.diagnostics().with_disparity);
  EXPECT_GE(static_cast<double>(with), 0.8 * static_cast<double>(frame.observations.size()));
  EXPECT_LT(tracker_.diagnostics().row_error_px, 0.15);
}

// A patch at the poster's edge shows the wall as well.
TEST_F(FeatureTrackerTest, MeasuresNoDepthBetweenAnEdgeAndWhatIsBehindIt) {
  const auto off_px = [&](const StereoObservation& o) {
    double least = 1e9;
    for (const double depth : {TexturedScene::kPoster_m, TexturedScene::kWall_m}) {
      const double z = depth - scene().stereo().T_body_cam0.p.z();
      const double ideal = scene().stereo().focal_px * scene().stereo().baseline_m / z;
      least = std::min(least, std::abs(o.disparity - ideal));
    }
    return least;
  };
  int measured = 0;
  int off = 0;
  for (int i = 0; i < 25; ++i) {
    const Eigen::Vector2d poster(-0.6 + 0.05 * i, 0.3 - 0.03 * i);
    FeatureTracker tracker(scene().calibration(), default_tracking_config());
    const auto frame =
        tracker.track(scene().render(Pose{}, poster), Eigen::Quaterniond::Identity());
    for (const StereoObservation& o : frame.observations) {
      if (o.disparity <= 0.0) continue;
      ++measured;
      if (off_px(o) > 0.25) ++off;
    }
  }
  std::cout << off << " of " << measured << " disparities are between those of the surfaces\n";
  EXPECT_GT(measured, 1500);
  EXPECT_LT(off, 15);
}

TEST_F(FeatureTrackerTest, LosesAndRejectsNothingAtStandstill) {
  const auto first = tracker_.track(scene().render(moving(0)), Eigen::Quaterniond::Identity());
  const auto second = tracker_.track(scene().render(moving(0)), Eigen::Quaterniond::Identity());
  EXPECT_EQ(tracker_.diagnostics().rejected_by_motion, 0);
  EXPECT_EQ(common(first, second), first.observations.size());
}

TEST_F(FeatureTrackerTest, RejectsLittleInPureRotation) {
  for (int i = 0; i < 6; ++i) {
    tracker_.track(scene().render(turning(i)), rotation(turning(i - 1), turning(i)));
    EXPECT_LE(tracker_.diagnostics().rejected_by_motion, 2);
    if (i > 0) {
      EXPECT_GT(tracker_.diagnostics().tracked, 40);
    }
  }
}

TEST_F(FeatureTrackerTest, FollowsAlsoWithoutAGyroscope) {
  for (int i = 0; i < 6; ++i) {
    tracker_.track(scene().render(turning(i)), Eigen::Quaterniond::Identity());
    EXPECT_LE(tracker_.diagnostics().rejected_by_motion, 3);
    if (i > 0) {
      EXPECT_GT(tracker_.diagnostics().tracked, 40);
    }
  }
}

TEST_F(FeatureTrackerTest, RejectsWhatMovesAgainstTheScene) {
  std::map<LandmarkId, int> on_poster;
  std::size_t tracked = 0;
  for (int i = 0; i < 6; ++i) {
    const Pose T = moving(i);
    const Eigen::Vector2d poster(-0.3 + 0.08 * i, -0.06 * i);
    const auto frame = tracker_.track(scene().render(T, poster), rotation(moving(i - 1), T));
    for (const auto& o : frame.observations) {
      const Pose T_world_cam = T * scene().stereo().T_body_cam0;
      const auto p_wall = scene().wall_point(T, o.left);
      const double share = (TexturedScene::kPoster_m - T_world_cam.p.z()) /
                           (TexturedScene::kWall_m - T_world_cam.p.z());
      const Eigen::Vector3d p = T_world_cam.p + share * (p_wall - T_world_cam.p);
      const double off_center = (p.head<2>() - poster).cwiseAbs().maxCoeff();
      if (off_center < TexturedScene::kPosterHalf_m - 0.05) ++on_poster[o.landmark];
    }
    if (i > 0) tracked += static_cast<std::size_t>(tracker_.diagnostics().tracked);
  }
  const auto twice = std::count_if(
      on_poster.begin(), on_poster.end(), [](const auto& entry) { return entry.second > 1; });
  EXPECT_GT(on_poster.size(), 20U);
  EXPECT_LE(twice, 1);
  EXPECT_GT(tracked, 250U);
}

TEST_F(FeatureTrackerTest, NeverUsesALandmarkIdTwice) {
  std::uint32_t largest = 0;
  for (int i = 0; i < 6; ++i) {
    auto images = scene().render(moving(i));
    if (i == 3) images.left.setTo(0);  // everything is lost
    const auto frame = tracker_.track(images, Eigen::Quaterniond::Identity());
    for (std::size_t k = 1; k < frame.observations.size(); ++k) {
      EXPECT_LT(frame.observations[k - 1].landmark, frame.observations[k].landmark);
    }
    if (i == 3) {
      EXPECT_TRUE(frame.observations.empty());
      continue;
    }
    const auto first = static_cast<std::uint32_t>(frame.observations.front().landmark);
    if (i == 4) {
      EXPECT_GT(first, largest);
    }
    largest = std::max(largest, static_cast<std::uint32_t>(frame.observations.back().landmark));
  }
}

TEST_F(FeatureTrackerTest, ResumesAfterAMissingLeftImage) {
  TrackedFrame before;
  for (int i = 0; i < 3; ++i) {
    before = tracker_.track(scene().render(moving(i)), rotation(moving(i - 1), moving(i)));
  }
  auto images = scene().render(moving(3));
  images.left.release();
  const auto during = tracker_.track(images, rotation(moving(2), moving(3)));
  EXPECT_TRUE(during.observations.empty());
  const auto after = tracker_.track(scene().render(moving(4)), rotation(moving(3), moving(4)));
  EXPECT_GT(common(before, after), before.observations.size() * 7 / 10);
}

TEST_F(FeatureTrackerTest, GoesOnWithoutARightImage) {
  for (int i = 0; i < 8; ++i) {
    auto images = scene().render(moving(i));
    const bool missing = i == 2 || i == 3 || i == 4;
    if (missing) images.right.release();
    const auto frame = tracker_.track(images, rotation(moving(i - 1), moving(i)));
    const int with = tracker_.diagnostics().with_disparity;
    EXPECT_GT(frame.observations.size(), 50U);
    EXPECT_LE(tracker_.diagnostics().rejected_by_motion, 3);
    if (missing) {
      EXPECT_EQ(with, 0);
    } else {
      EXPECT_GT(with, 40);
    }
  }
}

TEST_F(FeatureTrackerTest, StartsWithoutAnyImage) {
  const auto none = tracker_.track(StereoFrame{}, Eigen::Quaterniond::Identity());
  EXPECT_TRUE(none.observations.empty());
  const auto some = tracker_.track(scene().render(moving(0)), Eigen::Quaterniond::Identity());
  EXPECT_GT(some.observations.size(), 50U);
}

TEST_F(FeatureTrackerTest, IsTheSameEveryTimeAndWithThreads) {
  FeatureTracker other(scene().calibration(), default_tracking_config());
  for (int i = 0; i < 5; ++i) {
    const auto images = scene().render(moving(i), Eigen::Vector2d(0.05 * i, 0.0));
    cv::setNumThreads(1);
    const auto a = tracker_.track(images, rotation(moving(i - 1), moving(i)));
    cv::setNumThreads(4);
    const auto b = other.track(images, rotation(moving(i - 1), moving(i)));
    cv::setNumThreads(1);
    ASSERT_EQ(a.observations.size(), b.observations.size());
    for (std::size_t k = 0; k < a.observations.size(); ++k) {
      EXPECT_EQ(a.observations[k].landmark, b.observations[k].landmark);
      EXPECT_EQ(a.observations[k].left, b.observations[k].left);
      EXPECT_EQ(a.observations[k].disparity, b.observations[k].disparity);
    }
  }
}

TEST_F(FeatureTrackerTest, RefusesImagesThatAreNotAsCalibrated) {
  auto images = scene().render(moving(0));
  images.left = images.left.rowRange(0, 100);
  EXPECT_THROW(tracker_.track(images, Eigen::Quaterniond::Identity()), std::invalid_argument);
  images = scene().render(moving(0));
  images.right.convertTo(images.right, CV_16U);
  EXPECT_THROW(tracker_.track(images, Eigen::Quaterniond::Identity()), std::invalid_argument);
}

}  // namespace
}  // namespace fleetloc
