#include "robot/submap/sparsification.hpp"

#include <limits>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"
#include "test/unit/submap/simulated_window.hpp"

namespace fleetloc {
namespace {

using Refusal = SparsificationRefusal;
constexpr auto kBothModels = {InertialModel::kInertialMean, InertialModel::kPaper};

SimulatedRun noise_free_run() {
  return simulated_run(5, false);
}

InertialWindow some_window(std::size_t states = 10) {
  const SimulatedRun run = simulated_run(3, true);
  return SimulatedKeyframes(run, {}, static_cast<int>(states), 1).window(0, states);
}

template <typename T>
T expect_value(const Sparsified<T>& result) {
  if (!result) {
    ADD_FAILURE() << "refused: " << name(result.error());
    return {};
  }
  return result.value();
}

void expect_refused(Refusal reason,
                    const InertialWindow& window,
                    InertialModel model = InertialModel::kInertialMean) {
  const auto result = virtual_odometry(window, model);
  ASSERT_FALSE(result.has_value()) << "expected " << name(reason);
  EXPECT_EQ(name(result.error()), name(reason));
}

Matrix6d random_information(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Matrix6d root = Matrix6d::NullaryExpr([&] { return normal(random); });
  const Vector6d scale = (Vector6d() << 900, 800, 1000, 40, 50, 60).finished();
  return scale.asDiagonal() * (root.transpose() * root + 0.1 * Matrix6d::Identity()) *
         scale.asDiagonal();
}

Pose random_pose(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return exp_se3(Vector6d::NullaryExpr([&] { return normal(random); }));
}

/// Error of the relative pose `from` to `from` + 1, when all poses but the oldest move by x.
Vector6d relative_error(const std::vector<Pose>& poses,
                        std::size_t from,
                        const Eigen::VectorXd& x) {
  const auto moved = [&](std::size_t i) {
    return i == 0 ? poses[0]
                  : retract(poses[i], x.segment<6>(6 * (static_cast<Eigen::Index>(i) - 1)));
  };
  return log_se3(inverse(inverse(poses[from]) * poses[from + 1]) * inverse(moved(from)) *
                 moved(from + 1));
}

TEST(Sparsification, ReturnsIndependentConsecutiveEdgesExactly) {
  std::mt19937_64 random(4);
  constexpr std::size_t kPoses = 6;
  constexpr Eigen::Index kSize = 6 * (kPoses - 1);
  PoseInformation dense{{}, Eigen::MatrixXd::Zero(kSize, kSize), Eigen::VectorXd::Zero(kSize)};
  for (std::size_t i = 0; i < kPoses; ++i) dense.poses.push_back(random_pose(random));
  std::vector<Matrix6d> informations;
  for (std::size_t edge = 0; edge + 1 < kPoses; ++edge) {
    Eigen::MatrixXd J(6, kSize);
    constexpr double kStep = 1e-6;
    for (Eigen::Index i = 0; i < kSize; ++i) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(kSize, i);
      J.col(i) =
          (relative_error(dense.poses, edge, step) - relative_error(dense.poses, edge, -step)) /
          (2.0 * kStep);
    }
    informations.push_back(random_information(random));
    dense.information += J.transpose() * informations.back() * J;
  }
  const auto chain = expect_value(sparsify(dense, InertialModel::kInertialMean));
  ASSERT_EQ(chain.edges.size(), informations.size());
  for (std::size_t i = 0; i < informations.size(); ++i) {
    EXPECT_LE((chain.edges[i].information - informations[i]).norm(), 1e-6 * informations[i].norm());
    const Pose T = inverse(dense.poses[i]) * dense.poses[i + 1];
    EXPECT_LE(local_coordinates(T, chain.edges[i].T_from_to).norm(), 1e-12);
  }
  EXPECT_NEAR(chain.kl_divergence, 0.0, 1e-6);
}

TEST(Sparsification, NoOtherBlockDiagonalIsNearerInKlDivergence) {
  for (const InertialModel model : kBothModels) {
    const auto dense = expect_value(pose_information(some_window(), model));
    const auto chain = expect_value(sparsify(dense, model));
    const auto covariance = expect_value(relative_pose_covariance(dense));
    EXPECT_GT(chain.kl_divergence, 0.0);
    RecordProperty(model == InertialModel::kPaper ? "kl_paper" : "kl_inertial_mean",
                   std::to_string(chain.kl_divergence));
    std::mt19937_64 random(9);
    std::normal_distribution<double> normal;
    for (int trial = 0; trial < 300; ++trial) {
      const double size = std::pow(10.0, -1 - trial % 4);
      auto edges = chain.edges;
      for (RelativePose& edge : edges) {
        const Matrix6d mix =
            Matrix6d::Identity() + size * Matrix6d::NullaryExpr([&] { return normal(random); });
        const Eigen::LLT<Matrix6d> factor(edge.information);
        edge.information =
            factor.matrixL() * mix * mix.transpose() * factor.matrixU().toDenseMatrix();
      }
      EXPECT_GE(kl_divergence(covariance, edges), chain.kl_divergence - 1e-9);
    }
  }
}

TEST(Sparsification, NoEdgeClaimsMoreThanItsMarginal) {
  for (const InertialModel model : kBothModels) {
    const auto dense = expect_value(pose_information(some_window(), model));
    const auto chain = expect_value(sparsify(dense, model));
    const auto covariance = expect_value(relative_pose_covariance(dense));
    for (std::size_t i = 0; i < chain.edges.size(); ++i) {
      const auto row = 6 * static_cast<Eigen::Index>(i);
      const Eigen::LLT<Matrix6d> marginal(covariance.block<6, 6>(row, row));
      const Matrix6d L = marginal.matrixL();
      const Matrix6d claimed = L.transpose() * chain.edges[i].information * L;
      const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(claimed);
      EXPECT_LE(eigen.eigenvalues().maxCoeff(), 1.0 + 1e-6);
    }
  }
}

TEST(Sparsification, TheFirstEdgeHasTheCovarianceOfForwardPropagation) {
  const InertialWindow window = some_window();
  const auto chain = expect_value(virtual_odometry(window, InertialModel::kInertialMean));
  const Preintegration& step = window.between.front();
  const double dt = to_seconds(step.duration());
  const Eigen::Matrix3d R = window.states[0].T_odom_body.R.toRotationMatrix();
  // Of [rotation, position, velocity] by [velocity, gyroscope, accelerometer] at the start.
  Matrix9d F = Matrix9d::Zero();
  F.rightCols<6>() = step.bias_jacobian();
  F.block<3, 3>(3, 0) = dt * R.transpose();
  const Matrix9d sum = F * window.oldest_covariance * F.transpose() + step.covariance();
  // The deltas' position stands in the first body frame, the edge's in the second.
  Matrix6d T = Matrix6d::Identity();
  T.bottomRightCorner<3, 3>() = step.deltas(window.states[0].bias).R.conjugate().toRotationMatrix();
  const Matrix6d expected = T * sum.topLeftCorner<6, 6>() * T.transpose();
  const Matrix6d covariance = chain.edges.front().information.inverse();
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      // The states differ by what the odometry does not know: not at zero error.
      EXPECT_NEAR(
          covariance(i, j), expected(i, j), 1e-3 * std::sqrt(expected(i, i) * expected(j, j)));
    }
  }
}

TEST(Sparsification, TheInertialMeanRecoversTheNoiseFreeTruth) {
  const SimulatedRun run = noise_free_run();
  const SimulatedKeyframes keyframes(
      run, {.velocity_sigma = 0.0, .gyroscope_sigma = 0.0, .accelerometer_sigma = 0.0}, 10, 1);
  InertialWindow window = keyframes.window(0, 10);
  window.oldest_covariance = SimulatedOdometry{}.covariance();
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal;
  for (std::size_t i = 1; i < window.states.size(); ++i) {  // as if vision had moved them
    Vector6d xi = Vector6d::NullaryExpr([&] { return normal(random); });
    xi.head<3>() *= 2e-3;
    xi.tail<3>() *= 0.01;
    window.states[i].T_odom_body = retract(window.states[i].T_odom_body, xi);
    window.states[i].v_odom += 0.03 * Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
  }
  const auto mean = expect_value(virtual_odometry(window, InertialModel::kInertialMean));
  const auto paper = expect_value(virtual_odometry(window, InertialModel::kPaper));
  for (std::size_t i = 0; i < mean.edges.size(); ++i) {
    const Pose truth =
        inverse(keyframes.truth()[i].T_odom_body) * keyframes.truth()[i + 1].T_odom_body;
    const Pose estimate = inverse(window.states[i].T_odom_body) * window.states[i + 1].T_odom_body;
    const Vector6d error = local_coordinates(truth, mean.edges[i].T_from_to);
    EXPECT_LE(error.head<3>().norm(), 1e-4);  // second order in the disturbance
    EXPECT_LE(error.tail<3>().norm(), 1e-3);
    EXPECT_LE(local_coordinates(estimate, paper.edges[i].T_from_to).norm(), 1e-12);
  }
}

TEST(Sparsification, RefusesWindowsWithoutAnEdge) {
  expect_refused(Refusal::kTooFewKeyframes, {});
  expect_refused(Refusal::kTooFewKeyframes, some_window(2));
  EXPECT_EQ(expect_value(virtual_odometry(some_window(3), InertialModel::kPaper)).edges.size(), 2U);
  InertialWindow window = some_window();
  window.between.pop_back();
  expect_refused(Refusal::kUnequalSizes, window);
}

TEST(Sparsification, RefusesWhatIsNotFinite) {
  InertialWindow window = some_window();
  window.states[3].v_odom.x() = std::numeric_limits<double>::quiet_NaN();
  expect_refused(Refusal::kNotFinite, window);
}

TEST(Sparsification, RefusesSingularCases) {
  InertialWindow window = some_window();
  window.oldest_covariance.setZero();
  expect_refused(Refusal::kSingularPrior, window);
  // The oldest pose alone leaves nine directions undetermined.
  window.oldest_covariance = 1e30 * Matrix9d::Identity();
  expect_refused(Refusal::kSingularPoses, window);

  const SimulatedRun run = noise_free_run();
  window.between[4] = Preintegration(run.imu(keyframe_stamp(4), keyframe_stamp(5)), {}, {});
  expect_refused(Refusal::kSingularMeasurement, window);
}

}  // namespace
}  // namespace fleetloc
