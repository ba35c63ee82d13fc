#include "robot/inertial/imu_factor.hpp"

#include <array>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>

#include "test/unit/inertial/inertial_fixtures.hpp"

namespace fleetloc {
namespace {

using Blocks = std::array<Eigen::Matrix<double, 15, Eigen::Dynamic, Eigen::RowMajor>, 4>;

// Two states off the truth by so much that no term of a Jacobian is small, and the bias away from
// the point of linearization.
struct Scene {
  SimulatedRun run{lively()};
  Timestamp from = at_second(2.0);
  Timestamp to = at_second(2.4);
  Preintegration preintegration{run.imu(from, to), {}, run.noise()};
  NavState first = plus(run.truth(from), change(1.0));
  NavState second = plus(run.truth(to), change(-0.7));

  static Vector15d change(double scale) {
    Vector15d result;
    result << 0.2, -0.3, 0.1, 0.3, 0.2, -0.4, 0.5, -0.2, 0.3, 0.02, -0.01, 0.03, 0.2, 0.1, -0.2;
    return scale * result;
  }
};

struct Evaluation {
  Vector15d residual;
  Blocks jacobians;

  // By the tangent of one state, in the order of NavState.
  [[nodiscard]] Matrix15d jacobian(int state) const {
    const std::size_t pose = 2 * static_cast<std::size_t>(state);
    Matrix15d result;
    result << jacobians[pose].leftCols<6>(), jacobians[pose + 1];
    return result;
  }
};

Evaluation evaluate(const ImuFactor& factor, const NavState& first, const NavState& second) {
  const auto pose_1 = to_parameters(first.T_odom_body);
  const auto speed_1 = to_speed_bias(first);
  const auto pose_2 = to_parameters(second.T_odom_body);
  const auto speed_2 = to_speed_bias(second);
  const std::array parameters{pose_1.data(), speed_1.data(), pose_2.data(), speed_2.data()};
  Evaluation result;
  std::array<double*, 4> jacobians{};
  for (std::size_t i = 0; i < 4; ++i) {
    result.jacobians[i].setConstant(15, i % 2 == 0 ? 7 : 9, 1e9);
    jacobians[i] = result.jacobians[i].data();
  }
  EXPECT_TRUE(factor.Evaluate(parameters.data(), result.residual.data(), jacobians.data()));
  return result;
}

template <typename Function>
Matrix15d numeric_jacobian(const Function& error_at) {
  constexpr double kStep = 1e-6;
  Matrix15d J;
  for (int i = 0; i < 15; ++i) {
    const Vector15d step = kStep * Vector15d::Unit(i);
    J.col(i) = (error_at(step) - error_at(Vector15d(-step))) / (2.0 * kStep);
  }
  return J;
}

TEST(ImuError, IsZeroAtTheTruth) {
  const Scene scene;
  const ImuBias bias = lively().initial_bias;
  const ImuError error = imu_error(scene.preintegration.relinearized(bias),
                                   scene.run.truth(scene.from),
                                   scene.run.truth(scene.to));
  EXPECT_LT(error.error.norm(), 3e-5);
}

TEST(ImuError, IsZeroAtThePrediction) {
  const Scene scene;
  const ImuError error =
      imu_error(scene.preintegration, scene.first, scene.preintegration.predict(scene.first));
  EXPECT_LT(error.error.norm(), 1e-12);
}

TEST(ImuError, JacobiansMatchDifferences) {
  const Scene scene;
  const ImuError error = imu_error(scene.preintegration, scene.first, scene.second);
  const Matrix15d first = numeric_jacobian([&](const Vector15d& d) {
    return imu_error(scene.preintegration, plus(scene.first, d), scene.second).error;
  });
  const Matrix15d second = numeric_jacobian([&](const Vector15d& d) {
    return imu_error(scene.preintegration, scene.first, plus(scene.second, d)).error;
  });
  EXPECT_LT((first - error.J_first).cwiseAbs().maxCoeff(), 1e-7) << first - error.J_first;
  EXPECT_LT((second - error.J_second).cwiseAbs().maxCoeff(), 1e-7) << second - error.J_second;
}

// The IMU sees neither position nor heading.
TEST(ImuError, DoesNotChangeWithPositionAndYaw) {
  const Scene scene;
  const ImuError error = imu_error(scene.preintegration, scene.first, scene.second);
  const auto directions = [](const NavState& state) {
    const Eigen::Matrix3d R_body_odom = state.T_odom_body.R.toRotationMatrix().transpose();
    Eigen::Matrix<double, 15, 4> N = Eigen::Matrix<double, 15, 4>::Zero();
    N.block<3, 3>(3, 0) = R_body_odom;
    N.block<3, 1>(0, 3) = R_body_odom.col(2);
    N.block<3, 1>(3, 3) = R_body_odom * Eigen::Vector3d::UnitZ().cross(state.T_odom_body.p);
    N.block<3, 1>(6, 3) = Eigen::Vector3d::UnitZ().cross(state.v_odom);
    return N;
  };
  const Eigen::Matrix<double, 15, 4> change =
      error.J_first * directions(scene.first) + error.J_second * directions(scene.second);
  EXPECT_LT(change.cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ImuFactor, ResidualIsWhitenedByTheCovariance) {
  const Scene scene;
  const ImuFactor factor(scene.preintegration);
  const Vector15d error = imu_error(scene.preintegration, scene.first, scene.second).error;
  const Matrix15d covariance = imu_error_covariance(scene.preintegration);
  const double expected = error.dot(covariance.llt().solve(error));
  const double found = evaluate(factor, scene.first, scene.second).residual.squaredNorm();
  EXPECT_NEAR(found / expected, 1.0, 1e-9);
}

TEST(ImuFactor, JacobiansMatchDifferencesInCeresOrder) {
  const Scene scene;
  const ImuFactor factor(scene.preintegration);
  const Evaluation here = evaluate(factor, scene.first, scene.second);
  const Matrix15d first = numeric_jacobian([&](const Vector15d& d) {
    return evaluate(factor, plus(scene.first, d), scene.second).residual;
  });
  const Matrix15d second = numeric_jacobian([&](const Vector15d& d) {
    return evaluate(factor, scene.first, plus(scene.second, d)).residual;
  });
  for (int row = 0; row < 15; ++row) {
    const double scale = first.row(row).norm();
    EXPECT_LT((first - here.jacobian(0)).row(row).norm(), 1e-7 * scale) << row;
    EXPECT_LT((second - here.jacobian(1)).row(row).norm(), 1e-7 * scale) << row;
  }
  EXPECT_EQ(here.jacobians[0].col(6).norm(), 0.0);
  EXPECT_EQ(here.jacobians[2].col(6).norm(), 0.0);
}

TEST(ImuFactor, WritesOnlyTheJacobiansThatAreAskedFor) {
  const Scene scene;
  const ImuFactor factor(scene.preintegration);
  const Evaluation all = evaluate(factor, scene.first, scene.second);
  const auto pose_1 = to_parameters(scene.first.T_odom_body);
  const auto speed_1 = to_speed_bias(scene.first);
  const auto pose_2 = to_parameters(scene.second.T_odom_body);
  const auto speed_2 = to_speed_bias(scene.second);
  const std::array parameters{pose_1.data(), speed_1.data(), pose_2.data(), speed_2.data()};
  Vector15d residual;
  EXPECT_TRUE(factor.Evaluate(parameters.data(), residual.data(), nullptr));
  EXPECT_EQ(residual, all.residual);
  Eigen::Matrix<double, 15, 9, Eigen::RowMajor> J;
  std::array<double*, 4> jacobians{nullptr, nullptr, nullptr, J.data()};
  EXPECT_TRUE(factor.Evaluate(parameters.data(), residual.data(), jacobians.data()));
  EXPECT_EQ(J, all.jacobians[3]);
}

TEST(ImuFactor, TakesJacobiansAtFirstEstimatesAndTheResidualAtTheCurrentValue) {
  const Scene scene;
  const NavState old = plus(scene.first, Scene::change(0.3));
  const PoseParameters pose = to_parameters(old.T_odom_body);
  const SpeedBiasParameters speed_bias = to_speed_bias(old);
  const ImuFactor current(scene.preintegration);
  const ImuFactor first(scene.preintegration, {&pose, &speed_bias});

  const Evaluation found = evaluate(first, scene.first, scene.second);
  EXPECT_EQ(found.residual, evaluate(current, scene.first, scene.second).residual);
  const Evaluation expected = evaluate(current, old, scene.second);
  EXPECT_EQ(found.jacobian(0), expected.jacobian(0));
  EXPECT_EQ(found.jacobian(1), expected.jacobian(1));
  EXPECT_GT((found.jacobian(0) - evaluate(current, scene.first, scene.second).jacobian(0)).norm(),
            1.0);
}

TEST(ImuFactor, HonoursEveryFirstEstimateOnItsOwn) {
  const Scene scene;
  const NavState old = plus(scene.second, Scene::change(0.3));
  const PoseParameters pose = to_parameters(old.T_odom_body);
  const SpeedBiasParameters speed_bias = to_speed_bias(old);
  const ImuFactor current(scene.preintegration);

  NavState mixed = scene.second;
  mixed.T_odom_body = old.T_odom_body;
  const ImuFactor by_pose(scene.preintegration, {}, {&pose, nullptr});
  EXPECT_EQ(evaluate(by_pose, scene.first, scene.second).jacobian(1),
            evaluate(current, scene.first, mixed).jacobian(1));

  mixed = old;
  mixed.T_odom_body = scene.second.T_odom_body;
  const ImuFactor by_speed(scene.preintegration, {}, {nullptr, &speed_bias});
  EXPECT_EQ(evaluate(by_speed, scene.first, scene.second).jacobian(1),
            evaluate(current, scene.first, mixed).jacobian(1));
}

TEST(SpeedBias, SurvivesTheWayToParametersAndBack) {
  const Scene scene;
  const auto pose = to_parameters(scene.first.T_odom_body);
  const auto speed_bias = to_speed_bias(scene.first);
  const NavState back = nav_state_from(pose.data(), speed_bias.data());
  EXPECT_EQ(back.v_odom, scene.first.v_odom);
  EXPECT_EQ(back.bias.gyroscope, scene.first.bias.gyroscope);
  EXPECT_EQ(back.bias.accelerometer, scene.first.bias.accelerometer);
  EXPECT_EQ(back.T_odom_body.p, scene.first.T_odom_body.p);
  EXPECT_LT(log_so3(back.T_odom_body.R.conjugate() * scene.first.T_odom_body.R).norm(), 1e-15);
}

}  // namespace
}  // namespace fleetloc
