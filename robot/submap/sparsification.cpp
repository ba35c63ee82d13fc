#include "robot/submap/sparsification.hpp"

#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "robot/inertial/imu_factor.hpp"
#include "robot/inertial/scaled_cholesky.hpp"

namespace fleetloc {
namespace {

using Refusal = SparsificationRefusal;

constexpr std::size_t kMinKeyframes = 3;
constexpr int kPose = 6;
constexpr int kSpeedBias = 9;

/// Column offsets of the states in Lambda_m: poses but the oldest, then velocities and biases.
/// Fixed states have no columns.
struct Columns {
  int states;
  InertialModel model;

  [[nodiscard]] static std::optional<int> pose(int state) {
    if (state == 0) return std::nullopt;
    return kPose * (state - 1);
  }
  [[nodiscard]] std::optional<int> speed_bias(int state) const {
    const int fixed = model == InertialModel::kPaper ? 1 : 0;
    if (state < fixed) return std::nullopt;
    return poses() + kSpeedBias * (state - fixed);
  }
  [[nodiscard]] int poses() const { return kPose * (states - 1); }
  [[nodiscard]] int all() const {
    return poses() + kSpeedBias * (model == InertialModel::kPaper ? states - 1 : states);
  }
};

/// Lambda_m and its information vector.
struct InertialInformation {
  Eigen::MatrixXd information;
  Eigen::VectorXd vector;
};

/// Adds one preintegration between states `first` and `first` + 1.
expected<void, Refusal> add_measurement(const InertialWindow& window,
                                        int first,
                                        const Columns& columns,
                                        InertialInformation& sum) {
  const auto i = static_cast<std::size_t>(first);
  const ImuError linear = imu_error(window.between[i], window.states[i], window.states[i + 1]);
  const ScaledCholesky covariance(imu_error_covariance(window.between[i]));
  if (!covariance.regular()) return unexpected(Refusal::kSingularMeasurement);
  const Matrix15d weight = covariance.inverse();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(15, columns.all());
  for (const auto& [state, J_state] :
       {std::pair{first, &linear.J_first}, std::pair{first + 1, &linear.J_second}}) {
    if (const auto column = Columns::pose(state)) {
      J.middleCols<kPose>(*column) = J_state->leftCols<kPose>();
    }
    if (const auto column = columns.speed_bias(state)) {
      J.middleCols<kSpeedBias>(*column) = J_state->rightCols<kSpeedBias>();
    }
  }
  if (!J.allFinite() || !linear.error.allFinite()) return unexpected(Refusal::kNotFinite);
  sum.information += J.transpose() * weight * J;
  sum.vector -= J.transpose() * weight * linear.error;
  return {};
}

/// A: Jacobian of the consecutive relative poses by all poses but the oldest, at zero error.
Eigen::MatrixXd relative_pose_jacobian(const std::vector<Pose>& poses) {
  const auto edges = static_cast<Eigen::Index>(poses.size()) - 1;
  Eigen::MatrixXd A = Eigen::MatrixXd::Identity(kPose * edges, kPose * edges);
  for (Eigen::Index i = 1; i < edges; ++i) {
    const auto from = static_cast<std::size_t>(i);
    A.block<kPose, kPose>(kPose * i, kPose * (i - 1)) =
        -adjoint(inverse(poses[from + 1]) * poses[from]);
  }
  return A;
}

std::vector<Pose> mean_of(const PoseInformation& dense, const ScaledCholesky& information) {
  const Eigen::VectorXd delta = information.solve(dense.vector);
  std::vector<Pose> mean = dense.poses;
  for (std::size_t i = 1; i < mean.size(); ++i) {
    const auto row = kPose * (static_cast<Eigen::Index>(i) - 1);
    mean[i] = retract(mean[i], delta.segment<kPose>(row));
  }
  return mean;
}

}  // namespace

std::string_view name(SparsificationRefusal refusal) {
  switch (refusal) {
    case Refusal::kTooFewKeyframes:
      return "too_few_keyframes";
    case Refusal::kUnequalSizes:
      return "unequal_sizes";
    case Refusal::kNotFinite:
      return "not_finite";
    case Refusal::kSingularMeasurement:
      return "singular_measurement";
    case Refusal::kSingularPrior:
      return "singular_prior";
    case Refusal::kSingularMarginal:
      return "singular_marginal";
    case Refusal::kSingularPoses:
      return "singular_poses";
  }
  return "unknown";
}

Sparsified<PoseInformation> pose_information(const InertialWindow& window, InertialModel model) {
  if (window.states.size() < kMinKeyframes) return unexpected(Refusal::kTooFewKeyframes);
  if (window.between.size() + 1 != window.states.size()) return unexpected(Refusal::kUnequalSizes);
  const Columns columns{static_cast<int>(window.states.size()), model};
  InertialInformation sum{Eigen::MatrixXd::Zero(columns.all(), columns.all()),
                          Eigen::VectorXd::Zero(columns.all())};
  for (int first = 0; first + 1 < columns.states; ++first) {
    const auto added = add_measurement(window, first, columns, sum);
    if (!added) return unexpected(added.error());
  }
  if (const auto column = columns.speed_bias(0)) {  // its mean is the linearization point
    const ScaledCholesky covariance(window.oldest_covariance);
    if (!covariance.regular()) return unexpected(Refusal::kSingularPrior);
    sum.information.block<kSpeedBias, kSpeedBias>(*column, *column) += covariance.inverse();
  }
  const int kept = columns.poses();
  const int removed = columns.all() - kept;
  const ScaledCholesky L_removed(sum.information.bottomRightCorner(removed, removed));
  if (!L_removed.regular()) return unexpected(Refusal::kSingularMarginal);
  const Eigen::MatrixXd L_mixed = sum.information.bottomLeftCorner(removed, kept);
  PoseInformation dense;
  dense.information =
      sum.information.topLeftCorner(kept, kept) - L_mixed.transpose() * L_removed.solve(L_mixed);
  dense.vector =
      sum.vector.head(kept) - L_mixed.transpose() * L_removed.solve(sum.vector.tail(removed));
  for (const NavState& state : window.states) dense.poses.push_back(state.T_odom_body);
  return dense;
}

Sparsified<Eigen::MatrixXd> relative_pose_covariance(const PoseInformation& dense) {
  const ScaledCholesky information(dense.information);
  if (!information.regular()) return unexpected(Refusal::kSingularPoses);
  const Eigen::MatrixXd A = relative_pose_jacobian(dense.poses);
  return Eigen::MatrixXd(A * information.inverse() * A.transpose());
}

Sparsified<ChainOfPoses> sparsify(const PoseInformation& dense, InertialModel model) {
  const auto covariance = relative_pose_covariance(dense);
  if (!covariance) return unexpected(covariance.error());
  const Eigen::MatrixXd& C = *covariance;
  const std::vector<Pose> measured = model == InertialModel::kPaper
                                         ? dense.poses
                                         : mean_of(dense, ScaledCholesky(dense.information));
  ChainOfPoses chain;
  for (std::size_t i = 0; i + 1 < measured.size(); ++i) {
    const auto row = kPose * static_cast<Eigen::Index>(i);
    const ScaledCholesky marginal(C.block<kPose, kPose>(row, row));
    if (!marginal.regular()) return unexpected(Refusal::kSingularPoses);
    chain.edges.push_back({inverse(measured[i]) * measured[i + 1], marginal.inverse()});
  }
  chain.kl_divergence = kl_divergence(C, chain.edges);
  return chain;
}

Sparsified<ChainOfPoses> virtual_odometry(const InertialWindow& window, InertialModel model) {
  return pose_information(window, model).and_then([&](const PoseInformation& dense) {
    return sparsify(dense, model);
  });
}

double kl_divergence(const Eigen::MatrixXd& relative_pose_covariance,
                     const std::vector<RelativePose>& edges) {
  double twice = -ScaledCholesky(relative_pose_covariance).log_determinant();
  Eigen::Index row = 0;
  for (const RelativePose& edge : edges) {
    const auto marginal = relative_pose_covariance.block<kPose, kPose>(row, row);
    twice += (edge.information * marginal).trace() - kPose -
             ScaledCholesky(edge.information).log_determinant();
    row += kPose;
  }
  return 0.5 * twice;
}

}  // namespace fleetloc
