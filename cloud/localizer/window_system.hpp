#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "shared/core/ids.hpp"
#include "shared/factors/normal_equations.hpp"
#include "shared/geometry/pose.hpp"

namespace fleetloc {

/// E_loc linearized at the window's present values, landmarks eliminated: once with everything, and
/// once with only the relative measurements of the robot (its edges and observations). The tilt is
/// measured by the robot as well, but it constrains only the attitude of the window as a whole.
struct WindowSystem {
  struct Landmark {
    LandmarkId id{};
    Eigen::Vector3d p_map = Eigen::Vector3d::Zero();  ///< [m]
    bool is_matched = false;
    Eigen::Matrix3d H_robot = Eigen::Matrix3d::Zero();  ///< given the poses, map axes [1/m^2]
    PointEquations equations;  ///< with everything; kept blocks are indices of `keyframes`
  };

  std::vector<KeyframeId> keyframes;  ///< oldest first
  std::vector<Pose> T_map_body;
  Eigen::LLT<Eigen::MatrixXd> cholesky;  ///< of the whole system, right perturbations of the poses
  Eigen::MatrixXd H_robot;  ///< of the robot's factors alone: singular, since its gauge is free
  std::vector<Landmark> landmarks;  ///< increasing by id

  /// Of the newest keyframe's pose, right perturbation.
  [[nodiscard]] std::optional<Matrix6d> covariance_of_newest() const;

  [[nodiscard]] std::size_t memory_bytes() const;
};

/// The last `size` rows and columns of (L L^T)^-1.
Eigen::MatrixXd last_of_inverse(const Eigen::LLT<Eigen::MatrixXd>& cholesky, Eigen::Index size);

}  // namespace fleetloc
