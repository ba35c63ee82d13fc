#include "shared/factors/normal_equations.hpp"

#include <memory>
#include <random>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "shared/factors/point_factors.hpp"
#include "shared/factors/relative_pose_factor.hpp"
#include "shared/factors/reprojection_factor.hpp"

namespace fleetloc {
namespace {

constexpr int kPoses = 3;
constexpr int kPoints = 5;

// Three poses in a row that look at five points; noisy measurements, robust kernel.
class NormalEquationsTest : public testing::Test {
 protected:
  NormalEquationsTest() {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    const RectifiedStereo stereo{400.0, {300.0, 200.0}, 0.1, Pose{}};
    for (int i = 0; i < kPoses; ++i) {
      poses_.push_back(to_parameters(Pose{Eigen::Quaterniond::Identity(), {0.3 * i, 0.0, 0.0}}));
    }
    for (int i = 0; i < kPoints; ++i) {
      points_.push_back({uniform(random), uniform(random), 4.0 + uniform(random)});
    }
    for (PoseParameters& pose : poses_) {
      for (PointParameters& point : points_) {
        const Eigen::Vector3d pixel =
            project(stereo, inverse(pose_from(pose.data())) * Eigen::Vector3d(point.data()));
        const StereoObservation observation{
            LandmarkId{},
            pixel.head<2>() + Eigen::Vector2d(uniform(random), uniform(random)),
            pixel(0) - pixel(2) + uniform(random)};
        add(std::make_unique<StereoReprojectionFactor>(observation, stereo, StereoNoise{0.5}),
            {pose.data(), point.data()},
            &loss_);
      }
    }
    add(std::make_unique<PosePriorFactor>(Pose{}, 100.0 * Matrix6d::Identity()),
        {poses_[0].data()},
        nullptr);
    add(std::make_unique<RelativePoseFactor>(Pose{}, Matrix6d::Identity()),
        {poses_[2].data(), poses_[1].data()},
        nullptr);
  }

  void add(std::unique_ptr<ceres::CostFunction> cost,
           std::vector<const double*> parameters,
           const ceres::LossFunction* loss) {
    blocks_.push_back({cost.get(), loss, std::move(parameters)});
    costs_.push_back(std::move(cost));
  }

  [[nodiscard]] std::vector<ParameterBlock> pose_blocks() const {
    std::vector<ParameterBlock> kept;
    for (const PoseParameters& pose : poses_) {
      kept.push_back({pose.data(), 6});
    }
    return kept;
  }

  [[nodiscard]] std::vector<const double*> point_pointers() const {
    std::vector<const double*> pointers;
    for (const PointParameters& point : points_) {
      pointers.push_back(point.data());
    }
    return pointers;
  }

  // Everything kept: poses, then points.
  [[nodiscard]] NormalEquations dense() const {
    std::vector<ParameterBlock> kept = pose_blocks();
    for (const PointParameters& point : points_) {
      kept.push_back({point.data(), 3});
    }
    return schur_complement(blocks_, kept, {});
  }

  ceres::HuberLoss loss_{1.0};
  std::vector<PoseParameters> poses_;
  std::vector<PointParameters> points_;
  std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
  std::vector<ResidualBlock> blocks_;
};

TEST_F(NormalEquationsTest, GradientIsThatOfTheRobustCost) {
  const NormalEquations system = dense();
  const auto cost = [&] { return dense().cost; };
  constexpr double kStep = 1e-6;
  for (int i = 0; i < kPoses * 6; ++i) {
    PoseParameters& pose = poses_[static_cast<std::size_t>(i / 6)];
    const PoseParameters before = pose;
    const Vector6d step = kStep * Vector6d::Unit(i % 6);
    const Vector6d back = -step;
    PoseManifold().Plus(before.data(), step.data(), pose.data());
    const double plus = cost();
    PoseManifold().Plus(before.data(), back.data(), pose.data());
    const double minus = cost();
    pose = before;
    EXPECT_NEAR(system.g(i), (plus - minus) / (2.0 * kStep), 1e-5 * system.g.norm());
  }
}

TEST_F(NormalEquationsTest, SchurComplementIsTheDenseOne) {
  const NormalEquations all = dense();
  const NormalEquations reduced = schur_complement(blocks_, pose_blocks(), point_pointers());
  constexpr int kKept = 6 * kPoses;
  constexpr int kRest = 3 * kPoints;
  const Eigen::MatrixXd gain =
      all.H.topRightCorner(kKept, kRest) * all.H.bottomRightCorner(kRest, kRest).inverse();
  const Eigen::MatrixXd H =
      all.H.topLeftCorner(kKept, kKept) - gain * all.H.bottomLeftCorner(kRest, kKept);
  const Eigen::VectorXd g = all.g.head(kKept) - gain * all.g.tail(kRest);
  EXPECT_LT((reduced.H - H).norm(), 1e-9 * all.H.norm());
  EXPECT_LT((reduced.g - g).norm(), 1e-9 * all.g.norm());
  EXPECT_EQ(reduced.H, reduced.H.transpose());
  EXPECT_DOUBLE_EQ(reduced.cost, all.cost);
}

TEST_F(NormalEquationsTest, ParametersInNeitherListAreConstant) {
  const NormalEquations all = dense();
  const NormalEquations some =
      schur_complement(blocks_, {{poses_[2].data(), 6}, {poses_[0].data(), 6}}, {});
  EXPECT_LT((some.H.topLeftCorner<6, 6>() - all.H.block<6, 6>(12, 12)).norm(), 1e-9);
  EXPECT_LT((some.H.bottomRightCorner<6, 6>() - all.H.topLeftCorner<6, 6>()).norm(), 1e-9);
  EXPECT_LT((some.g.tail<6>() - all.g.head<6>()).norm(), 1e-9);
}

TEST(NormalEquations, ASingularPointSaysNothingInItsNullDirections) {
  const PointParameters point{1.0, 2.0, 3.0};
  const PointToPlaneFactor plane({0, 0, 0}, {0, 0, 1}, 1.0);
  const NormalEquations system =
      schur_complement({{&plane, nullptr, {point.data()}}}, {}, {point.data()});
  EXPECT_EQ(system.H.size(), 0);
  EXPECT_DOUBLE_EQ(system.cost, 4.5);
}

}  // namespace
}  // namespace fleetloc
