// Answers that come late, in any order, repeated or wrong: the result is that of a batch.
#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <unsupported/Eigen/MatrixFunctions>

#include "robot/fusion/pose_fusion.hpp"
#include "test/unit/fusion/fed_fusion.hpp"

namespace fleetloc {
namespace {

constexpr double kEnd = 28.0;  // within the buffer

// Tilted as little as the answers err in the batch test.
Pose nearly_level_alignment() {
  return {exp_so3({2e-5, -1e-5, 0.8}), {10.0, -4.0, 1.5}};
}

Vector6d random_vector(std::mt19937& generator, double sigma) {
  std::normal_distribution<double> normal(0.0, sigma);
  return Vector6d::NullaryExpr([&] { return normal(generator); });
}

Matrix6d body_to_map_axes(const Pose& T_map_body) {
  return adjoint({T_map_body.R, Eigen::Vector3d::Zero()});
}

struct Arrival {
  double t;  ///< [s]
  LocalizationResult answer;
};

// Answers for a frame every 0.7 to 2 s, up to 20 s late.
std::vector<Arrival> some_arrivals(std::mt19937& generator, double error_sigma) {
  std::vector<Arrival> arrivals;
  std::uniform_int_distribution<int> interval(7, 20);
  std::uniform_real_distribution<double> delay(0.2, 20.0);
  const CircularDrive drive;
  for (int tenths = 10; tenths < 250; tenths += interval(generator)) {
    const double t = 0.1 * tenths;
    const Pose T_map_body =
        retract(nearly_level_alignment() * drive.pose(t), random_vector(generator, error_sigma));
    arrivals.push_back({std::min(kEnd, t + delay(generator)), answer(t, T_map_body)});
  }
  return arrivals;
}

MapOdomEstimate fuse(std::vector<Arrival> arrivals, const PoseFusion::Config& config) {
  std::stable_sort(arrivals.begin(), arrivals.end(), [](const Arrival& a, const Arrival& b) {
    return a.t < b.t;
  });
  FedFusion fed(config);
  for (const Arrival& arrival : arrivals) {
    fed.drive_to(arrival.t);
    fed.fusion.add_answer(arrival.answer);
  }
  fed.drive_to(kEnd + 0.1);
  return *fed.fusion.session_start();
}

// The same model as one linear least-squares problem about the true T_map_odom: unknowns d_k and
// u_k of every answer; drift and memory between them, tilt at the first.
class Batch {
 public:
  Batch(std::vector<Arrival> arrivals, const PoseFusion::Config& config) : config_(config) {
    std::sort(arrivals.begin(), arrivals.end(), [](const Arrival& a, const Arrival& b) {
      return a.answer.stamp < b.answer.stamp;
    });
    const auto n = static_cast<Eigen::Index>(arrivals.size());
    information_ = Eigen::MatrixXd::Zero(12 * n, 12 * n);
    vector_ = Eigen::VectorXd::Zero(12 * n);
    add_tilt();
    add(Matrix6d::Identity(), {{6, Matrix6d::Identity()}}, Vector6d::Zero());
    for (Eigen::Index k = 0; k < n; ++k) {
      const LocalizationResult& now = arrivals[static_cast<std::size_t>(k)].answer;
      if (k > 0) {
        add_evolution(arrivals[static_cast<std::size_t>(k - 1)].answer, now, k);
      }
      add_answer(now, k);
    }
    const Eigen::MatrixXd covariance = information_.inverse();
    d_last_ = (covariance * vector_).segment<6>(12 * (n - 1));
    covariance_last_ = covariance.block<6, 6>(12 * (n - 1), 12 * (n - 1));
    covariance_last_ += drift(arrivals.back().answer.stamp, at(kEnd));
  }
  [[nodiscard]] const Vector6d& d_last() const { return d_last_; }
  [[nodiscard]] const Matrix6d& covariance_last() const { return covariance_last_; }

 private:
  struct Block {
    Eigen::Index column;
    Matrix6d J;
  };

  // sum of J x - residual, with that covariance
  void add(const Matrix6d& covariance, const std::vector<Block>& blocks, const Vector6d& residual) {
    const Matrix6d weight = covariance.inverse();
    for (const Block& a : blocks) {
      vector_.segment<6>(a.column) += a.J.transpose() * weight * residual;
      for (const Block& b : blocks) {
        information_.block<6, 6>(a.column, b.column) += a.J.transpose() * weight * b.J;
      }
    }
  }
  void add_tilt() {
    const Eigen::Vector3d up = nearly_level_alignment().R.conjugate() * Eigen::Vector3d::UnitZ();
    const Eigen::Matrix<double, 2, 3> J = hat(up).topRows<2>();
    const double weight = 1.0 / (config_.answers.map_tilt * config_.answers.map_tilt);
    information_.topLeftCorner<3, 3>() += weight * J.transpose() * J;
    vector_.head<3>() -= weight * J.transpose() * up.head<2>();
  }
  [[nodiscard]] Matrix6d drift(Timestamp from, Timestamp to) const {
    const CircularDrive drive;
    OdometryDrift model(config_.drift);
    Matrix6d sum = Matrix6d::Zero();
    for (int i = 0; at(0.1 * i) <= to; ++i) {
      const Matrix6d Q = model.step(odometry(0.1 * i, drive.state(0.1 * i))).covariance;
      sum += at(0.1 * i) > from ? Q : Matrix6d::Zero().eval();
    }
    return sum;
  }
  static Matrix6d covariance_map(const LocalizationResult& answer) {
    const Matrix6d A = body_to_map_axes(answer.T_map_body);
    return A * answer.covariance * A.transpose();
  }
  // What both answers share has the smaller of their covariances, both at the later place.
  static Matrix6d error_transition(const LocalizationResult& from, const LocalizationResult& to) {
    const Pose lever{Eigen::Quaterniond::Identity(), from.T_map_body.p - to.T_map_body.p};
    const Matrix6d carry = adjoint(lever);
    const Matrix6d before = carry * covariance_map(from) * carry.transpose();
    const Matrix6d after = covariance_map(to);
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> eigen(after, before);
    const Matrix6d W = eigen.eigenvectors().inverse();
    const Matrix6d shared = W.transpose() * eigen.eigenvalues().cwiseMin(1.0).asDiagonal() * W;
    return after.sqrt().inverse() * shared * before.inverse() * carry * covariance_map(from).sqrt();
  }
  void add_evolution(const LocalizationResult& from, const LocalizationResult& to, Eigen::Index k) {
    const Matrix6d I = Matrix6d::Identity();
    add(drift(from.stamp, to.stamp), {{12 * (k - 1), -I}, {12 * k, I}}, Vector6d::Zero());
    const double overlap = to_seconds(from.stamp - to.oldest_stamp) / kWindow;
    const Matrix6d F = overlap * error_transition(from, to);
    add(I - F * F.transpose(), {{12 * (k - 1) + 6, -F}, {12 * k + 6, I}}, Vector6d::Zero());
  }
  void add_answer(const LocalizationResult& now, Eigen::Index k) {
    const LocalizationNoise& noise = config_.answers.noise;
    const Pose T_odom_body = CircularDrive{}.pose(to_seconds(now.stamp - Timestamp{}));
    const Matrix6d A = body_to_map_axes(now.T_map_body);
    const Matrix6d root_map = covariance_map(now).sqrt();
    const Matrix6d J_error = std::sqrt(1.0 - noise.white_share) * A.transpose() * root_map;
    add(noise.white_share * now.covariance + clone_covariance(noise),
        {{12 * k, adjoint(inverse(T_odom_body))}, {12 * k + 6, J_error}},
        local_coordinates(nearly_level_alignment() * T_odom_body, now.T_map_body));
  }

  PoseFusion::Config config_;
  Eigen::MatrixXd information_;
  Eigen::VectorXd vector_;
  Vector6d d_last_;
  Matrix6d covariance_last_;
};

PoseFusion::Config ungated_config() {
  PoseFusion::Config config = fusion_config();
  config.answers.gate_chi_square = 1e6;
  config.answers.tilt_gate_chi_square = 1e6;
  return config;
}

TEST(LateAnswers, GiveTheBatchSolution) {
  // Small errors keep the problem linear, so that filter and batch agree to second order.
  constexpr double kErrorSigma = 1e-5;
  PoseFusion::Config config = ungated_config();
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 generator(seed);
    const std::vector<Arrival> arrivals = some_arrivals(generator, kErrorSigma);
    const MapOdomEstimate result = fuse(arrivals, config);
    const Batch batch(arrivals, config);
    const Vector6d d = local_coordinates(nearly_level_alignment(), result.T_map_odom);
    EXPECT_LT((d - batch.d_last()).norm(), 1e-3 * batch.d_last().norm())
        << d.transpose() << "\n"
        << batch.d_last().transpose();
    EXPECT_LT((result.covariance - batch.covariance_last()).norm(),
              1e-4 * batch.covariance_last().norm());
  }
}

// Each answer twice; of every third the second is a newer revision, half of them grossly wrong.
std::vector<Arrival> repeated_and_revised(std::vector<Arrival> arrivals) {
  const std::size_t count = arrivals.size();
  for (std::size_t i = 0; i < count; ++i) {
    Arrival changed = arrivals[i];
    if (i % 3 == 1) {
      changed.answer.revision = Revision{2};
      changed.answer.T_map_body.p.x() += i % 2 == 0 ? 3.0 : 0.01;
    }
    arrivals.push_back(changed);
  }
  return arrivals;
}

std::vector<Arrival> delivered_at_once(std::vector<Arrival> arrivals) {
  for (Arrival& arrival : arrivals) {
    arrival.t = to_seconds(arrival.answer.stamp - Timestamp{}) + 0.2;
  }
  return arrivals;
}

std::vector<Arrival> delivered_at_random(std::vector<Arrival> arrivals, std::mt19937& generator) {
  std::shuffle(arrivals.begin(), arrivals.end(), generator);
  for (Arrival& arrival : arrivals) {
    const double earliest = to_seconds(arrival.answer.stamp - Timestamp{}) + 0.2;
    arrival.t = std::uniform_real_distribution<double>(earliest, kEnd)(generator);
  }
  return arrivals;
}

TEST(LateAnswers, GiveTheSameInAnyOrderWithOutliersAndRepetitions) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    std::mt19937 generator(seed);
    const auto arrivals = repeated_and_revised(some_arrivals(generator, 0.01));
    for (const PoseFusion::Config& config : {fusion_config(), coupled_config()}) {
      const MapOdomEstimate expected = fuse(delivered_at_once(arrivals), config);
      for (int permutation = 0; permutation < 3; ++permutation) {
        const MapOdomEstimate result = fuse(delivered_at_random(arrivals, generator), config);
        EXPECT_LT(local_coordinates(expected.T_map_odom, result.T_map_odom).norm(), 1e-9);
        EXPECT_LT((expected.covariance - result.covariance).norm(), 1e-12);
      }
    }
  }
}

TEST(LateAnswers, TurnVerdictsThatStoodOnLess) {
  // The first answer is wrong, so the good one after it is refused, until better ones come.
  PoseFusion::Config config = fusion_config();
  FedFusion fed(config);
  fed.drive_to(10.0);
  Pose wrong = true_T_map_odom();
  wrong.p.x() += 2.0;
  EXPECT_TRUE(fed.answer_at(5.0, wrong).has_value());
  EXPECT_EQ(name(fed.answer_at(8.0)), "gated");
  EXPECT_TRUE(fed.answer_at(4.0).has_value());
  // The wrong one is gated now, the good one applied: newer revisions of them are told so.
  const auto told_again = [&](double t, const Pose& T_map_odom) {
    LocalizationResult again = answer(t, T_map_odom * fed.drive.pose(t));
    again.revision = Revision{1};
    return name(fed.fusion.add_answer(again));
  };
  EXPECT_EQ(told_again(5.0, wrong), "gated");
  EXPECT_EQ(told_again(8.0, true_T_map_odom()), "applied");
  EXPECT_LT((fed.fusion.session_start()->T_map_odom.p - true_T_map_odom().p).norm(), 0.05);
}

void expect_no_effect_of_the_buffer(const PoseFusion::Config& config) {
  PoseFusion::Config short_buffer = config;
  short_buffer.buffer_s = 10.0;
  FedFusion a(short_buffer);
  FedFusion b(config);
  for (int i = 1; i <= 25; ++i) {
    for (FedFusion* fed : {&a, &b}) {
      fed->drive_to(1.0 * i + 1.0);
      Pose T_map_odom = true_T_map_odom();
      T_map_odom.p.y() += 0.01 * i;
      EXPECT_TRUE(fed->answer_at(1.0 * i, T_map_odom).has_value());
    }
  }
  EXPECT_EQ(a.fusion.session_start()->covariance, b.fusion.session_start()->covariance);
  EXPECT_EQ(a.fusion.session_start()->T_map_odom.p, b.fusion.session_start()->T_map_odom.p);
}

TEST(LateAnswers, HaveTheirEffectAlsoAfterTheyLeftTheBuffer) {
  expect_no_effect_of_the_buffer(fusion_config());
  expect_no_effect_of_the_buffer(coupled_config());
}

}  // namespace
}  // namespace fleetloc
