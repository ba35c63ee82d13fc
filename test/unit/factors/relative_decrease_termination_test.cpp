#include "shared/factors/relative_decrease_termination.hpp"

#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>
#include <gtest/gtest.h>

namespace fleetloc {
namespace {

/// Residuals x and 1: from x = 1, one step takes half of the cost away, all that there is.
class HalfOfIt final : public ceres::SizedCostFunction<2, 1> {
 public:
  bool Evaluate(const double* const* parameters,
                double* residuals,
                double** jacobians) const override {
    residuals[0] = *parameters[0];
    residuals[1] = 1.0;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      jacobians[0][0] = 1.0;
      jacobians[0][1] = 0.0;
    }
    return true;
  }
};

ceres::Solver::Summary solved(double share, double& x) {
  ceres::Problem problem;
  problem.AddResidualBlock(new HalfOfIt, nullptr, &x);
  RelativeDecreaseTermination ends(share);
  ceres::Solver::Options options;
  options.callbacks.push_back(&ends);
  options.function_tolerance = 0.0;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return summary;
}

TEST(RelativeDecreaseTermination, KeepsTheStepThatIsTheLast) {
  double x = 1.0;
  const ceres::Solver::Summary summary = solved(0.6, x);
  EXPECT_EQ(summary.termination_type, ceres::USER_SUCCESS);
  EXPECT_EQ(summary.num_successful_steps, 2);  // the first is where it begins
  EXPECT_NEAR(x, 0.0, 1e-3);
}

TEST(RelativeDecreaseTermination, GoesOnAfterAGreaterOne) {
  double x = 1.0;
  const ceres::Solver::Summary summary = solved(0.4, x);
  EXPECT_GT(summary.num_successful_steps, 2);
  EXPECT_NEAR(x, 0.0, 1e-6);
}

}  // namespace
}  // namespace fleetloc
