#pragma once

#include <ceres/iteration_callback.h>

namespace fleetloc {

/// Terminates an optimization after the first successful step whose relative cost decrease is at
/// most `share`. With function_tolerance Ceres would compute one more step and discard it.
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
