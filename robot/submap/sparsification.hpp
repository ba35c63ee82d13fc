#pragma once

#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "robot/inertial/inertial_window.hpp"
#include "shared/core/expected.hpp"
#include "shared/geometry/pose.hpp"

/// Virtual odometry: the IMU's information on the poses of a window, as independent relative poses
/// between consecutive ones (paper, section III-A: "Marginalize the velocity and bias nodes").
namespace fleetloc {

enum class InertialModel {
  /// The oldest pose is fixed, its velocity and biases have their marginal in the odometry as a
  /// prior; the measured values are the mean of the inertial distribution, without vision.
  kInertialMean,
  /// As in the paper: the oldest state is fixed, velocity and biases with it; the measured values
  /// are the odometry's estimates.
  kPaper,
};

/// Why there is no virtual odometry.
enum class SparsificationRefusal {
  kTooFewKeyframes,      ///< fewer than three
  kUnequalSizes,         ///< not one preintegration between each two states
  kNotFinite,            ///< a state, an error, a covariance
  kSingularMeasurement,  ///< covariance of a preintegration
  kSingularPrior,        ///< covariance of the oldest velocity and biases
  kSingularMarginal,     ///< velocities and biases cannot be eliminated
  kSingularPoses,        ///< the poses are not determined, or an edge is not
};

/// Name in logs and summaries.
std::string_view name(SparsificationRefusal refusal);

template <typename T>
using Sparsified = expected<T, SparsificationRefusal>;

/// Gaussian over the poses of a window but the oldest, which is fixed. Tangent coordinates at
/// `poses`, six a pose: exp(-0.5 x^T information x + vector^T x).
struct PoseInformation {
  std::vector<Pose> poses;      ///< T_odom_body, n, oldest first
  Eigen::MatrixXd information;  ///< Lambda_t, 6 (n-1) square
  Eigen::VectorXd vector;       ///< 6 (n-1)
};

/// Lambda_m from preintegration and bias walk over poses, velocities and biases, linearized at the
/// window's states; then Lambda_t by the Schur complement that eliminates velocities and biases
/// (paper, eq. 5 and 6).
Sparsified<PoseInformation> pose_information(const InertialWindow& window, InertialModel model);

/// One relative pose; its error is Log(T_from_to^-1 * T_odom_from^-1 * T_odom_to).
struct RelativePose {
  Pose T_from_to;
  Matrix6d information = Matrix6d::Identity();
};

struct ChainOfPoses {
  std::vector<RelativePose> edges;  ///< n - 1, oldest first
  double kl_divergence = 0.0;       ///< of the dense distribution from the chain [nat]
};

/// The chain of independent relative poses that is nearest to the dense distribution in the
/// Kullback-Leibler divergence: X_i = ({A Lambda_t^-1 A^T}_i)^-1 (paper, eq. 8; Wang, Xiong and
/// Huang, 2015). T_from_to is taken at poses [+] Lambda_t^-1 vector with kInertialMean, else at the
/// poses themselves.
Sparsified<ChainOfPoses> sparsify(const PoseInformation& dense, InertialModel model);

/// pose_information() and sparsify().
Sparsified<ChainOfPoses> virtual_odometry(const InertialWindow& window, InertialModel model);

/// Covariance of the consecutive relative poses in the dense distribution: A Lambda_t^-1 A^T.
Sparsified<Eigen::MatrixXd> relative_pose_covariance(const PoseInformation& dense);

/// KL(N(0, covariance) || N(0, X^-1)) of a chain with those informations X [nat].
double kl_divergence(const Eigen::MatrixXd& relative_pose_covariance,
                     const std::vector<RelativePose>& edges);

}  // namespace fleetloc
