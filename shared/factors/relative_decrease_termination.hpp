#pragma once

#include <ceres/iteration_callback.h>

namespace fleetloc {

/// Ends an optimization with the first step that lowered the cost by no more than a share of it.
/// By its own function tolerance Ceres computes one step more, and drops it.
class RelativeDecreaseTermination final : public ceres::IterationCallback {
 public:
  explicit RelativeDecreaseTermination(double share) : share_(share) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    const bool is_step = summary.iteration > 0 && summary.step_is_successful;
    const double before = summary.cost + summary.cost_change;
    return is_step && summary.cost_change <= share_ * before ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
                                                             : ceres::SOLVER_CONTINUE;
  }

 private:
  double share_;
};

}  // namespace fleetloc
