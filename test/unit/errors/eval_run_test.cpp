#include "deploy/evaluation/errors/eval_run.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <set>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "deploy/evaluation/errors/diagnostics_file.hpp"
#include "shared/config/delimited_file.hpp"
#include "shared/geometry/angle.hpp"
#include "shared/geometry/so3.hpp"
#include "shared/trajectory/tum_file.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {
namespace {

using ::testing::HasSubstr;

constexpr int kFrames = 2000;

Timestamp at_frame(int frame) {
  return Timestamp(std::chrono::milliseconds(1'000'000 + 50 * frame));
}

Pose T_map_body(int frame) {
  const double t = 0.05 * frame;
  return {.R = exp_so3({0.1, 0.2 * std::sin(t), t}),
          .p = {std::cos(t), 2.0 * std::sin(t), 0.1 * t}};
}

Trajectory truth() {
  Trajectory trajectory;
  for (int i = 0; i < kFrames; ++i) trajectory.push_back({at_frame(i), T_map_body(i)});
  return trajectory;
}

Vector6d sigmas() {
  return (Vector6d() << 0.003, 0.006, 0.002, 0.03, 0.02, 0.04).finished();
}

std::string triangle(const Matrix6d& matrix) {
  std::ostringstream text;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) text << ',' << matrix(row, column);
  }
  return text.str();
}

std::string header() {
  std::string text = "stamp_s,state,since_last_answer_s";
  for (const char* prefix : {"cm", "co"}) {
    for (int row = 1; row <= 6; ++row) {
      for (int column = row; column <= 6; ++column) {
        text += "," + (prefix + std::to_string(row)) + std::to_string(column);
      }
    }
  }
  return text + ",keyframe\n";
}

std::string stamp_text(int frame) {
  std::ostringstream line;
  write_tum_line(line, at_frame(frame), {});
  return line.str().substr(0, line.str().find(' '));
}

/// A run with the errors that its covariance states; in odom it states half the sigmas. There is a
/// pose from the first frame on, and a localization from the hundredth on.
class EvaluateRun : public ::testing::Test {
 protected:
  EvaluateRun() {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    std::ofstream localization(folder_ / "localization_frames.tum");
    std::ofstream odometry(folder_ / "odometry.tum");
    std::ofstream diagnostics(folder_ / "diagnostics.csv");
    diagnostics << header();
    const Pose T_odom_map{.R = exp_so3({0.0, 0.0, 1.1}), .p = {3.0, -2.0, 1.0}};
    const Matrix6d covariance = sigmas().cwiseAbs2().asDiagonal();
    const Matrix6d unknown = Matrix6d::Constant(std::nan(""));
    for (int i = 0; i < kFrames; ++i) {
      const bool localized = i >= 100;
      if (localized)
        write_tum_line(localization, at_frame(i), retract(T_map_body(i), draw_error()));
      // The first pose of odometry is exact: it defines the frame.
      const Vector6d error = i == 0 ? Vector6d::Zero() : draw_error();
      write_tum_line(odometry, at_frame(i), retract(T_odom_map * T_map_body(i), error));
      diagnostics << stamp_text(i) << ",localized,0.5" << triangle(localized ? covariance : unknown)
                  << triangle(covariance / 4.0) << ",1\n";
    }
    std::ofstream(folder_ / "summary.json") << R"({"coverage": 0.95})";
  }

  Vector6d draw_error() {
    Vector6d error;
    for (int i = 0; i < 6; ++i) error(i) = sigmas()(i) * normal_(random_);
    return error;
  }

  void displace_localization(const std::set<int>& frames,
                             double metres,
                             double degrees = 0.0) const {
    const auto file = folder_ / "localization_frames.tum";
    const Trajectory poses = read_trajectory(file);
    std::ofstream stream(file);
    for (const StampedPose& pose : poses) {
      const bool is_displaced =
          std::ranges::any_of(frames, [&pose](int frame) { return at_frame(frame) == pose.stamp; });
      Vector6d displacement = Vector6d::Zero();
      if (is_displaced) displacement << degrees * kRadPerDeg, 0.0, 0.0, metres, 0.0, 0.0;
      write_tum_line(stream, pose.stamp, retract(pose.T_ref_body, displacement));
    }
  }

  void replace_in_diagnostics(int frame, const std::string& text, const std::string& by) const {
    const auto file = folder_ / "diagnostics.csv";
    std::stringstream content;
    content << std::ifstream(file).rdbuf();
    std::ofstream stream(file);
    for (std::string line; std::getline(content, line);) {
      const auto place = line.find(text);
      if (line.starts_with(stamp_text(frame)) && place != std::string::npos) {
        line.replace(place, text.size(), by);
      }
      stream << line << '\n';
    }
  }

  static EvaluationConfig config() {
    return read_evaluation_config(
        ConfigReader::from_string(default_config("eval")).section("evaluation"));
  }

  const std::filesystem::path folder_ =
      test_folder() / "fleetloc_evaluate_run" /
      ::testing::UnitTest::GetInstance()->current_test_info()->name();
  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
};

TEST_F(EvaluateRun, FindsTheErrorsThatWereMade) {
  const auto evaluation = evaluate_run(folder_, truth(), config());
  const double expected_m = sigmas().tail<3>().norm();
  const double expected_deg = sigmas().head<3>().norm() * 180.0 / M_PI;
  EXPECT_NEAR(evaluation["ate"]["rmse"].get<double>(), expected_m, 0.03 * expected_m);
  EXPECT_NEAR(evaluation["odometry_ate"]["rmse"].get<double>(), expected_m, 0.03 * expected_m);
  EXPECT_NEAR(evaluation["rotation_deg"]["rmse"].get<double>(), expected_deg, 0.03 * expected_deg);
  EXPECT_EQ(evaluation["coverage"], 0.95);
}

// Errors of both ends: sqrt(2) of one pose in rotation, and a lever arm of what the first one's
// rotation does to ten seconds of motion.
TEST_F(EvaluateRun, FindsTheRelativeErrorOfTheOdometry) {
  const auto relative = evaluate_run(folder_, truth(), config())["odometry_relative"];
  EXPECT_NEAR(relative["pairs"].get<int>(), kFrames - 200, 3);  // ends within the largest gap
  const double expected_deg = std::sqrt(2.0) * sigmas().head<3>().norm() * 180.0 / M_PI;
  EXPECT_NEAR(relative["rotation_rmse_deg"].get<double>(), expected_deg, 0.05 * expected_deg);
  EXPECT_GT(relative["translation_rmse_m"].get<double>(),
            std::sqrt(2.0) * sigmas().tail<3>().norm());
  EXPECT_LT(relative["translation_rmse_m"].get<double>(), 0.15);
}

TEST_F(EvaluateRun, HasNoRelativeErrorForARunShorterThanTheInterval) {
  Trajectory start = truth();
  start.resize(150);
  EXPECT_TRUE(evaluate_run(folder_, start, config())["odometry_relative"].is_null());
}

TEST_F(EvaluateRun, FindsNeesNearOneForAnHonestCovarianceAndFourForHalfTheSigmas) {
  const auto evaluation = evaluate_run(folder_, truth(), config());
  EXPECT_NEAR(evaluation["nees"]["map"].get<double>(), 1.0, 0.05);
  EXPECT_NEAR(evaluation["nees"]["odom"].get<double>(), 4.0, 0.2);
}

// The control starts with the error of one pose, which its lever arm carries along.
TEST_F(EvaluateRun, ComparesWithTheControlThatIsAlignedOnce) {
  const auto before = evaluate_run(folder_, truth(), config());
  const auto& control = before["aligned_once"];
  EXPECT_DOUBLE_EQ(control["ratio"]["rmse"].get<double>(),
                   control["ate"]["rmse"].get<double>() / before["ate"]["rmse"].get<double>());
  EXPECT_DOUBLE_EQ(control["ratio"]["median"].get<double>(),
                   control["ate"]["median"].get<double>() / before["ate"]["median"].get<double>());
  EXPECT_LT(control["ate"]["rmse"].get<double>(), 0.3);

  displace_localization({100}, 2.0);  // the first pose in the map
  const auto after = evaluate_run(folder_, truth(), config());
  EXPECT_NEAR(after["aligned_once"]["ate"]["median"].get<double>(), 2.0, 0.3);
  EXPECT_NEAR(after["ate"]["median"].get<double>(), before["ate"]["median"].get<double>(), 1e-3);
}

TEST_F(EvaluateRun, CoversFramesThatAreLocalizedAndTrulyWithinTheLimits) {
  const auto covered_frames = [this] {
    return kFrames * evaluate_run(folder_, truth(), config())["covered"].get<double>();
  };
  EXPECT_DOUBLE_EQ(covered_frames(), kFrames - 100);
  displace_localization({200}, 0.1, 1.0);
  EXPECT_DOUBLE_EQ(covered_frames(), kFrames - 100);
  displace_localization({201, 202}, 0.5);
  EXPECT_DOUBLE_EQ(covered_frames(), kFrames - 102);
  displace_localization({203}, 0.0, 10.0);
  EXPECT_DOUBLE_EQ(covered_frames(), kFrames - 103);
  replace_in_diagnostics(204, ",localized,", ",dead_reckoning,");
  EXPECT_DOUBLE_EQ(covered_frames(), kFrames - 104);
}

TEST_F(EvaluateRun, CountsEachFrameFromTheFirstPoseOnThatHasGroundTruthForWhatIsCovered) {
  for (int i = 0; i < 50; ++i) replace_in_diagnostics(i, ",localized,", ",initializing,");
  replace_in_diagnostics(60, ",localized,", ",initializing,");
  EXPECT_DOUBLE_EQ(evaluate_run(folder_, truth(), config())["covered"].get<double>(),
                   (kFrames - 100.0) / (kFrames - 50));
  Trajectory start = truth();
  start.resize(1000);
  EXPECT_DOUBLE_EQ(evaluate_run(folder_, start, config())["covered"].get<double>(), 900.0 / 950);
}

TEST_F(EvaluateRun, CountsFramesThatAreWrongAndSureOfIt) {
  const auto before = evaluate_run(folder_, truth(), config())["confidence"];
  EXPECT_EQ(before["localized_frames"], kFrames - 100);
  EXPECT_LT(before["worst_m"].get<double>(), 6.0 * sigmas().tail<3>().norm());
  EXPECT_EQ(before["wrong"], 0);
  EXPECT_EQ(before["confidently_wrong"], 0);

  displace_localization({200, 201}, 2.0);
  displace_localization({202}, 0.0, 30.0);
  const auto after = evaluate_run(folder_, truth(), config())["confidence"];
  EXPECT_NEAR(after["worst_m"].get<double>(), 2.0, 0.3);
  EXPECT_NEAR(after["worst_deg"].get<double>(), 30.0, 5.0);
  EXPECT_EQ(after["wrong"], 3);
  EXPECT_EQ(after["confidently_wrong"], 3);
}

TEST_F(EvaluateRun, DoesNotCallAnErrorConfidentThatTheCovarianceStates) {
  displace_localization({200, 201}, 2.0);
  const auto all = evaluate_run(folder_, truth(), config())["confidence"];
  ASSERT_EQ(all["confidently_wrong"], 2);
  replace_in_diagnostics(
      200, triangle(sigmas().cwiseAbs2().asDiagonal()), triangle(Matrix6d::Identity()));
  replace_in_diagnostics(201, ",localized,", ",dead_reckoning,");
  const auto rest = evaluate_run(folder_, truth(), config())["confidence"];
  EXPECT_EQ(rest["wrong"], 1);
  EXPECT_EQ(rest["confidently_wrong"], 0);
  EXPECT_EQ(rest["localized_frames"], kFrames - 101);
}

TEST_F(EvaluateRun, HasNoMapErrorsForARunThatWasNeverLocalized) {
  std::ofstream(folder_ / "localization_frames.tum").close();
  std::filesystem::remove(folder_ / "summary.json");
  const auto evaluation = evaluate_run(folder_, truth(), config());
  EXPECT_TRUE(evaluation["ate"].is_null());
  EXPECT_TRUE(evaluation["aligned_once"].is_null());
  EXPECT_TRUE(evaluation["coverage"].is_null());
  EXPECT_EQ(evaluation["covered"], 0.0);
  EXPECT_TRUE(evaluation["nees"]["map"].is_null());
  EXPECT_FALSE(evaluation["odometry_ate"].is_null());
}

TEST_F(EvaluateRun, RefusesTheTruthOfAnotherRecording) {
  Trajectory other = truth();
  for (StampedPose& pose : other) pose.stamp += std::chrono::hours(24);
  try {
    evaluate_run(folder_, other, config());
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(folder_.string() + ": no pose of odometry.tum"));
  }
}

TEST_F(EvaluateRun, NamesAMissingColumn) {
  std::ofstream(folder_ / "diagnostics.csv") << "stamp_s,state\n";
  try {
    evaluate_run(folder_, truth(), config());
    FAIL();
  } catch (const TextFileError& error) {
    EXPECT_THAT(error.what(), HasSubstr("diagnostics.csv:1: there is no column 'cm11'"));
  }
}

TEST(Evaluate, RefusesAnEstimateWithoutGroundTruth) {
  const Trajectory later = {{.stamp = at_frame(kFrames + 100), .T_ref_body = {}}};
  EXPECT_THROW(
      evaluate(
          truth(), later, Alignment::kSe3, {std::chrono::seconds(1), std::chrono::seconds(10)}),
      std::runtime_error);
}

}  // namespace
}  // namespace fleetloc
