// Covariances of relative quantities against the joint system of poses and landmark, with Jacobians
// from finite differences.
#include "cloud/localizer/relative_covariance.hpp"

#include <functional>
#include <vector>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "shared/core/counter_random.hpp"
#include "shared/geometry/so3.hpp"

namespace fleetloc {
namespace {

constexpr int kFirst = 4;  // the window's index of the oldest pose here
constexpr int kPoses = 3;
constexpr Eigen::Index kLandmark = 6 * kPoses;  // column
constexpr Eigen::Index kColumns = kLandmark + 3;
constexpr double kStep = 1e-5;

using Perturbation = Eigen::Matrix<double, kColumns, 1>;

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::uint64_t stream) {
  const CounterRandom random(3, stream);
  std::uint64_t counter = 0;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return random.normal3(counter++).x(); });
}

// Three poses and a landmark that the first and the last of them observe.
class JointSystem {
 public:
  JointSystem() {
    const Eigen::MatrixXd J_poses = random_matrix(kLandmark, kLandmark, 0);
    information_.topLeftCorner(kLandmark, kLandmark) =
        J_poses.transpose() * J_poses + Eigen::MatrixXd::Identity(kLandmark, kLandmark);
    for (const int observer : {0, kPoses - 1}) {
      Eigen::MatrixXd J = Eigen::MatrixXd::Zero(4, kColumns);
      const auto stream = static_cast<std::uint64_t>(observer) + 1;
      J.middleCols<6>(6 * observer) = random_matrix(4, 6, stream);
      J.rightCols<3>() = random_matrix(4, 3, stream + 10);
      information_ += J.transpose() * J;
      landmark_.equations.couplings.push_back(
          {kFirst + observer, J.middleCols<6>(6 * observer).transpose() * J.rightCols<3>()});
    }
    landmark_.p_map = {4.0, -1.0, 2.0};
    landmark_.equations.H = information_.bottomRightCorner<3, 3>();
  }

  [[nodiscard]] Pose pose(int index, const Perturbation& x = Perturbation::Zero()) const {
    const double at = index;
    const Pose T{exp_so3({0.3 * at, -0.2, 0.5 + at}), {1.0 * at, -0.4, 0.2 * at}};
    return retract(T, x.segment<6>(6 * Eigen::Index{index}));
  }
  [[nodiscard]] Eigen::Vector3d p_anchor(const Perturbation& x) const {
    return inverse(pose(kPoses - 1, x)) * (landmark_.p_map + x.tail<3>());
  }

  [[nodiscard]] PoseCovariances poses() const {
    return {information_.inverse().topLeftCorner(kLandmark, kLandmark), kFirst};
  }
  [[nodiscard]] const WindowSystem::Landmark& landmark() const { return landmark_; }

  // Of the joint system's covariance.
  [[nodiscard]] Eigen::MatrixXd propagated(
      const std::function<Eigen::VectorXd(const Perturbation&)>& quantity) const {
    Eigen::MatrixXd J(quantity(Perturbation::Zero()).size(), kColumns);
    for (Eigen::Index i = 0; i < kColumns; ++i) {
      const Perturbation step = kStep * Perturbation::Unit(i);
      J.col(i) = (quantity(step) - quantity(-step)) / (2.0 * kStep);
    }
    return J * information_.inverse() * J.transpose();
  }

 private:
  Eigen::MatrixXd information_ = Eigen::MatrixXd::Zero(kColumns, kColumns);
  WindowSystem::Landmark landmark_;
};

TEST(PoseCovariances, OfAnAnchoredLandmarkAreThoseOfTheJointSystem) {
  const JointSystem system;
  const Eigen::Matrix3d covariance = system.poses().of_anchored_landmark(
      system.landmark(), system.landmark().equations.H, system.pose(kPoses - 1));
  const Eigen::MatrixXd expected =
      system.propagated([&](const Perturbation& x) { return system.p_anchor(x); });
  EXPECT_LT((covariance - expected).norm(), 1e-7 * expected.norm()) << covariance << "\n\n"
                                                                    << expected;
}

TEST(PoseCovariances, OfARelativePoseAreThoseOfTheJointSystem) {
  const JointSystem system;
  for (int a = 0; a < kPoses - 1; ++a) {
    const int b = a + 1;
    const Pose T_a_b = inverse(system.pose(a)) * system.pose(b);
    const Matrix6d covariance = system.poses().of_relative_pose(kFirst + a, kFirst + b, T_a_b);
    const Eigen::MatrixXd expected = system.propagated([&](const Perturbation& x) {
      return local_coordinates(T_a_b, inverse(system.pose(a, x)) * system.pose(b, x));
    });
    EXPECT_LT((covariance - expected).norm(), 1e-7 * expected.norm()) << a;
  }
}

}  // namespace
}  // namespace fleetloc
