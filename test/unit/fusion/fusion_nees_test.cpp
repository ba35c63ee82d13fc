// Is the covariance of the map pose honest when answers share their errors?
#include <cmath>
#include <iostream>
#include <random>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "test/unit/fusion/fed_fusion.hpp"

namespace fleetloc {
namespace {

constexpr int kSeeds = 60;
constexpr double kAnswerInterval = 1.0;  // [s]
constexpr double kAnswerDelay = 2.5;
constexpr double kRun = 60.0;

// Errors of the answers are constant-covariance Gauss-Markov in map axes, with a small white part;
// the odometry drifts and its frames jitter; the IMU is noisy.
class DriftingRun {
 public:
  DriftingRun(unsigned seed, const PoseFusion::Config& model) : model_(model), random_(seed) {
    u_ = standard_normal();
  }

  /// Runs `config`; returns the sum and the number of squared normalized errors.
  std::pair<double, int> squared_errors(const PoseFusion::Config& config) {
    const auto owned = make_pose_fusion(euroc_imu_noise(), config);
    PoseFusion& fusion = *owned;
    std::vector<LocalizationResult> sent;
    double sum = 0.0;
    int count = 0;
    for (int tick = 0; 0.02 * tick < kRun; ++tick) {
      const double t = 0.02 * tick;
      const PoseEstimate estimate = fusion.add_imu(noisy_imu(t));
      if (tick % 50 == 49 && t > 15.0) {
        const Vector6d error = local_coordinates(*estimate.T_map_body, drive_.pose(t));
        sum += error.dot(estimate.covariance_map.llt().solve(error));
        ++count;
      }
      if (tick % 5 == 2) {  // a frame, 40 ms late
        fusion.add_odometry(next_frame(0.02 * (tick - 2)));
      }
      if (tick % 50 == 2) {
        sent.push_back(next_answer(0.02 * (tick - 2)));
        const auto arrived = static_cast<std::size_t>(kAnswerDelay / kAnswerInterval);
        if (sent.size() > arrived) {
          refused_ += fusion.add_answer(sent[sent.size() - 1 - arrived]) ? 0 : 1;
        }
      }
    }
    return {sum, count};
  }
  [[nodiscard]] int refused() const { return refused_; }

 private:
  Vector6d standard_normal() {
    return Vector6d::NullaryExpr([this] { return normal_(random_); });
  }
  ImuSample noisy_imu(double t) {
    const double scale = 1.0 / std::sqrt(0.02);
    ImuSample sample = drive_.imu(t);
    const Vector6d noise = standard_normal();
    sample.angular_velocity += euroc_imu_noise().gyroscope_noise_density * scale * noise.head<3>();
    sample.specific_force +=
        euroc_imu_noise().accelerometer_noise_density * scale * noise.tail<3>();
    return sample;
  }
  OdometryEstimate next_frame(double t) {
    const OdometryDrift::Config& drift = model_.drift;
    const Pose T_odom_body = inverse(T_map_odom_) * drive_.pose(t);
    const double metres = t > 0.0 ? 0.1 * drive_.speed : 0.0;
    const double radians = t > 0.0 ? 0.1 * drive_.turn_rate() : 0.0;
    Vector6d sigma;
    sigma << drift.tilt, drift.tilt,
        std::sqrt(drift.yaw * drift.yaw +
                  drift.yaw_by_rotation * drift.yaw_by_rotation * radians / std::max(metres, 1e-9)),
        Eigen::Vector3d::Constant(drift.translation);
    const Vector6d step = std::sqrt(metres) * sigma.cwiseProduct(standard_normal());
    const Pose T_odom_place{Eigen::Quaterniond::Identity(), T_odom_body.p};
    T_map_odom_ = retract(T_map_odom_, adjoint(T_odom_place) * step);

    NavState state = drive_.state(t);
    state.T_odom_body = retract(inverse(T_map_odom_) * drive_.pose(t), frame_jitter());
    state.v_odom = T_map_odom_.R.conjugate() * state.v_odom + 0.01 * standard_normal().head<3>();
    return odometry(t, state);
  }
  Vector6d frame_jitter() {
    const LocalizationNoise& noise = model_.answers.noise;
    Vector6d sigma;
    sigma << Eigen::Vector3d::Constant(noise.clone_rotation),
        Eigen::Vector3d::Constant(noise.clone_translation);
    return sigma.cwiseProduct(standard_normal());
  }
  LocalizationResult next_answer(double t) {
    const double share = model_.answers.noise.white_share;
    const double rho = 1.0 - kAnswerInterval / kWindow;  // share of the window in both
    u_ = rho * u_ + std::sqrt(1.0 - rho * rho) * standard_normal();
    const Vector6d error_map = answer_covariance().cwiseSqrt() *
                               (std::sqrt(1.0 - share) * u_ + std::sqrt(share) * standard_normal());
    const Pose truth = drive_.pose(t);
    const Matrix6d A = adjoint({truth.R.conjugate(), Eigen::Vector3d::Zero()});
    LocalizationResult result = answer(t, retract(truth, A * error_map));
    result.covariance = A * answer_covariance() * A.transpose();
    result.covariance = 0.5 * (result.covariance + result.covariance.transpose()).eval();
    return result;
  }

  PoseFusion::Config model_;
  CircularDrive drive_;  ///< in the map
  Pose T_map_odom_;
  Vector6d u_;
  int refused_ = 0;
  std::mt19937 random_;
  std::normal_distribution<double> normal_{0.0, 1.0};
};

struct Result {
  double nees;  ///< per degree of freedom
  int refused;
};

Result run_all(const PoseFusion::Config& model, const PoseFusion::Config& config) {
  double sum = 0.0;
  int count = 0;
  int refused = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    DriftingRun run(seed, model);
    const auto [run_sum, run_count] = run.squared_errors(config);
    sum += run_sum;
    count += run_count;
    refused += run.refused();
  }
  return {sum / (6.0 * count), refused};
}

TEST(FusionNees, IsNearOneWithCorrelatedAnswers) {
  const auto [nees, refused] = run_all(fusion_config(), fusion_config());
  std::cout << "NEES per degree of freedom " << nees << ", " << refused << " answers refused\n";
  EXPECT_GT(nees, 0.8);
  EXPECT_LT(nees, 1.25);
  EXPECT_LT(refused, kSeeds);  // of about 60 each; the gate is at 0.1 %
}

TEST(FusionNees, WouldBeManyIfTheErrorsWereTakenForWhite) {
  PoseFusion::Config white = fusion_config();
  white.answers.noise.white_share = 1.0;
  const auto [nees, refused] = run_all(fusion_config(), white);
  std::cout << "NEES per degree of freedom, white noise assumed: " << nees << "\n";
  EXPECT_GT(nees, 3.0);
}

// The paper's filter takes all errors for white.
TEST(FusionNees, OfTheCoupledFilterIsNearOneWithWhiteErrors) {
  PoseFusion::Config white = fusion_config();
  white.answers.noise.white_share = 1.0;
  const auto [nees, refused] = run_all(white, coupled_config());
  std::cout << "NEES per degree of freedom, single filter, white errors: " << nees << ", "
            << refused << " answers refused\n";
  EXPECT_GT(nees, 0.8);
  EXPECT_LT(nees, 1.25);
  EXPECT_LT(refused, kSeeds);
}

TEST(FusionNees, OfTheCoupledFilterIsManyWithCorrelatedAnswers) {
  const auto [nees, refused] = run_all(fusion_config(), coupled_config());
  std::cout << "NEES per degree of freedom, single filter, correlated errors: " << nees << ", "
            << refused << " answers refused\n";
  EXPECT_GT(nees, 2.0);
}

// A robot at rest whose localizer has seen `answers` independent views; each answer is the mean of
// all views so far, as the cloud's growing window makes it. Squared normalized error at the end.
double squared_error_after_growing_window(unsigned seed, int answers) {
  PoseFusion::Config config = fusion_config();
  config.answers.map_tilt = 1.0;
  FedFusion fed(config);
  fed.drive.speed = 0.0;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Vector6d sigma = 3.0 * answer_covariance().diagonal().cwiseSqrt();
  Vector6d sum = Vector6d::Zero();
  for (int n = 1; n <= answers; ++n) {
    sum += sigma.cwiseProduct(Vector6d::NullaryExpr([&] { return normal(random); }));
    fed.drive_to(n + 0.5);
    LocalizationResult mean = answer(n, retract(fed.drive.pose(n), sum / n));
    mean.covariance = Matrix6d(sigma.cwiseAbs2().asDiagonal()) / n;
    EXPECT_TRUE(fed.fusion.add_answer(mean).has_value()) << "seed " << seed << ", answer " << n;
  }
  fed.drive_to(answers + 1.0);
  const Vector6d error = local_coordinates(*fed.output.T_map_body, fed.drive.pose(answers + 1.0));
  return error.dot(fed.output.covariance_map.llt().solve(error));
}

TEST(FusionNees, IsNotTooLargeWhenAnswersOfAGrowingWindowGetBetter) {
  double sum = 0.0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    sum += squared_error_after_growing_window(seed, 20);
  }
  const double nees = sum / (6.0 * kSeeds);
  std::cout << "NEES per degree of freedom, growing window: " << nees << "\n";
  EXPECT_GT(nees, 0.5);
  EXPECT_LT(nees, 1.3);
}

// A direction that the map hardly constrains: loose by half a metre along the map's x, with a turn
// for each metre; 1 cm and 2 mrad otherwise.
LocalizationResult loose_answer(double t, const Pose& T_map_body, double turn_rad_per_m) {
  Matrix6d covariance_map = Matrix6d::Zero();
  covariance_map.diagonal().head<3>().setConstant(0.002 * 0.002);
  covariance_map.diagonal().tail<3>().setConstant(0.01 * 0.01);
  Vector6d loose = Vector6d::Zero();
  loose(2) = 0.5 * turn_rad_per_m;
  loose(3) = 0.5;
  covariance_map += loose * loose.transpose();
  const Matrix6d A = adjoint({T_map_body.R.conjugate(), Eigen::Vector3d::Zero()});
  LocalizationResult result = answer(t, T_map_body);
  result.oldest_stamp = at(turn_rad_per_m < 0.0 ? 0.0009 : 0.0);  // told in whole milliseconds
  result.covariance = A * covariance_map * A.transpose();
  return result;
}

// The second answer has seen what the first has, and more: the two together know no more than it.
// Taken as two lines, they would cross within centimetres.
TEST(FusionNees, IsNoBetterThanTheLastAnswerOfAGrowingWindow) {
  FedFusion fed;
  fed.drive_to(2.5);
  const auto fuse = [&](double t, double turn_rad_per_m) {
    const LocalizationResult said =
        loose_answer(t, true_T_map_odom() * fed.drive.pose(t), turn_rad_per_m);
    EXPECT_EQ(name(fed.fusion.add_answer(said)), "applied");
    return said;
  };
  fuse(1.0, 0.03);
  const LocalizationResult last = fuse(2.0, -0.04);
  const Matrix6d found = fed.fusion.estimate_at(at(2.0))->covariance_map;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> ratio(found, last.covariance);
  std::cout << "variances by those of the answer: " << ratio.eigenvalues().transpose() << '\n';
  EXPECT_GT(ratio.eigenvalues()(0), 0.7);
}

// Nor do many answers at one place, each of which has forgotten the first keyframes of the one
// before: they all look at the same.
TEST(FusionNees, IsNoBetterThanTheBestAnswerOfASlidingWindowAtRest) {
  FedFusion fed;
  fed.drive.speed = 0.0;
  fed.drive_to(2.5);
  Matrix6d best = Matrix6d::Zero();
  for (int i = 0; i < 20; ++i) {
    const double t = 3.0 + 0.5 * i;
    LocalizationResult said =
        loose_answer(t, true_T_map_odom() * fed.drive.pose(t), i % 2 == 0 ? 0.03 : -0.04);
    said.oldest_stamp = at(t - kWindow);
    best = said.covariance;
    fed.drive_to(t + 0.3);
    EXPECT_EQ(name(fed.fusion.add_answer(said)), "applied");
  }
  const Matrix6d found = fed.fusion.estimate_at(at(12.5))->covariance_map;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> ratio(found, best);
  std::cout << "variances by those of the answer: " << ratio.eigenvalues().transpose() << '\n';
  EXPECT_GT(ratio.eigenvalues()(0), 0.7);
}

}  // namespace
}  // namespace fleetloc
