#pragma once

#include <vector>

#include <Eigen/Core>
#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include "shared/factors/parameters.hpp"

namespace fleetloc {

/// Moves a parameter block by `delta`: a pose on PoseManifold, anything else by addition.
inline std::vector<double> moved(const std::vector<double>& x, const Eigen::VectorXd& delta) {
  std::vector<double> result(x.size());
  if (x.size() == 7) {
    PoseManifold().Plus(x.data(), delta.data(), result.data());
  } else {
    Eigen::Map<Eigen::VectorXd>(result.data(), delta.size()) =
        Eigen::Map<const Eigen::VectorXd>(x.data(), delta.size()) + delta;
  }
  return result;
}

inline Eigen::VectorXd residual_of(const ceres::CostFunction& cost,
                                   const std::vector<std::vector<double>>& parameters) {
  std::vector<const double*> pointers;
  for (const auto& block : parameters) {
    pointers.push_back(block.data());
  }
  Eigen::VectorXd residual(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(pointers.data(), residual.data(), nullptr));
  return residual;
}

/// The analytic Jacobian of every block, as Ceres gets it (poses with their seventh column).
inline std::vector<Eigen::MatrixXd> jacobians_of(
    const ceres::CostFunction& cost, const std::vector<std::vector<double>>& parameters) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<const double*> pointers;
  std::vector<std::vector<double>> storage;
  std::vector<double*> targets;
  storage.reserve(parameters.size());
  for (const auto& block : parameters) {
    pointers.push_back(block.data());
    storage.emplace_back(static_cast<std::size_t>(cost.num_residuals()) * block.size(), 1e99);
    targets.push_back(storage.back().data());
  }
  Eigen::VectorXd residual(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(pointers.data(), residual.data(), targets.data()));
  std::vector<Eigen::MatrixXd> jacobians;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    jacobians.emplace_back(Eigen::Map<RowMajor>(
        targets[i], cost.num_residuals(), static_cast<Eigen::Index>(parameters[i].size())));
  }
  return jacobians;
}

/// Central differences by the tangent of block `index`.
inline Eigen::MatrixXd numeric_jacobian(const ceres::CostFunction& cost,
                                        const std::vector<std::vector<double>>& parameters,
                                        std::size_t index,
                                        double step = 1e-5) {
  const Eigen::Index size =
      parameters[index].size() == 7 ? 6 : static_cast<Eigen::Index>(parameters[index].size());
  Eigen::MatrixXd J(cost.num_residuals(), size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const Eigen::VectorXd delta = step * Eigen::VectorXd::Unit(size, i);
    auto plus = parameters;
    auto minus = parameters;
    plus[index] = moved(parameters[index], delta);
    minus[index] = moved(parameters[index], -delta);
    J.col(i) = (residual_of(cost, plus) - residual_of(cost, minus)) / (2.0 * step);
  }
  return J;
}

/// Every block's analytic Jacobian is the numeric one, relative to the largest entry.
inline void expect_numeric_jacobians(const ceres::CostFunction& cost,
                                     const std::vector<std::vector<double>>& parameters,
                                     double tolerance = 1e-7) {
  const std::vector<Eigen::MatrixXd> jacobians = jacobians_of(cost, parameters);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Eigen::MatrixXd numeric = numeric_jacobian(cost, parameters, i);
    const Eigen::MatrixXd analytic = jacobians[i].leftCols(numeric.cols());
    const double scale = std::max(1.0, numeric.cwiseAbs().maxCoeff());
    EXPECT_LT((analytic - numeric).cwiseAbs().maxCoeff(), tolerance * scale)
        << "block " << i << "\nanalytic\n"
        << analytic << "\nnumeric\n"
        << numeric;
    if (parameters[i].size() == 7) {
      EXPECT_TRUE(jacobians[i].col(6).isZero(0.0));
    }
  }
}

template <typename Array>
std::vector<double> block_of(const Array& values) {
  return {values.begin(), values.end()};
}

inline std::vector<double> block_of(const Pose& T) {
  return block_of(to_parameters(T));
}
inline std::vector<double> block_of(const Eigen::Vector3d& p) {
  return {p.x(), p.y(), p.z()};
}

}  // namespace fleetloc
