#pragma once

#include <map>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "shared/factors/normal_equations.hpp"
#include "shared/factors/parameters.hpp"
#include "shared/model/correction.hpp"
#include "simulated_session.hpp"

namespace fleetloc {

/// The effect of a correction on the robot: the estimate of its own window from its own
/// measurements (edges and observations of `keyframes` keyframes up to `newest`) and the items of
/// the correction as independent measurements. The newest keyframe is held at the truth, so that
/// the errors are those of relative quantities.
class RobotWindow {
 public:
  RobotWindow(const SimulatedSession& robot, int newest, int keyframes);

  /// Once.
  void solve(const Correction& correction);

  /// By the squared error of all poses together, per degree of freedom.
  [[nodiscard]] double pose_nees() const;
  /// Of the oldest keyframe alone: the whole length of the chain.
  [[nodiscard]] double oldest_nees() const;
  [[nodiscard]] Pose pose(KeyframeId id) const;
  [[nodiscard]] bool holds(LandmarkId id) const { return points_.contains(id); }
  [[nodiscard]] Eigen::Vector3d error(LandmarkId id) const;  ///< anchor axes [m]
  [[nodiscard]] double nees(LandmarkId id) const;            ///< per degree of freedom

 private:
  struct Landmark {
    PointParameters p{};
    Eigen::Matrix3d covariance;  // map axes
  };

  void add_measurements(int keyframe);
  void add_correction(const Correction& correction);
  void add(std::unique_ptr<ceres::CostFunction> cost, std::vector<double*> parameters);
  void linearize();
  [[nodiscard]] Vector6d error_of(KeyframeId id) const;

  const SimulatedSession& robot_;
  KeyframeId anchor_;
  std::map<KeyframeId, PoseParameters> poses_;
  std::map<LandmarkId, Landmark> points_;
  std::vector<std::unique_ptr<ceres::CostFunction>> costs_;
  std::vector<ResidualBlock> blocks_;
  Eigen::MatrixXd information_;  // of all poses but the newest, oldest first
};

}  // namespace fleetloc
