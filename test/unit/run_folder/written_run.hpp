#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "robot/run_folder/run_folder.hpp"
#include "test/test_folder.hpp"

namespace fleetloc {

inline Timestamp at(double seconds) {
  return Timestamp(std::chrono::seconds(1'403'715'274)) + from_seconds(seconds);
}

inline Duration lasting(double seconds) {
  return from_seconds(seconds);
}

/// A pose of odometry; one in the map as well where `quality` says that there is one.
inline PoseEstimate pose_estimate(double seconds,
                                  Quality quality,
                                  double since_last_answer_s = 0.0,
                                  bool in_map = true) {
  PoseEstimate pose;
  pose.stamp = at(seconds);
  pose.quality = quality;
  pose.since_last_answer = lasting(since_last_answer_s);
  pose.T_odom_body.p = {seconds, 0.0, 0.0};
  if (quality != Quality::kInitializing && in_map) {
    pose.T_map_body = Pose{.R = Eigen::Quaterniond::Identity(), .p = {0.0, seconds, 0.0}};
  }
  return pose;
}

inline FrameRecord frame(double seconds, Quality quality, double since_last_answer_s = 0.0) {
  return {.pose = pose_estimate(seconds, quality, since_last_answer_s), .round_trip = std::nullopt};
}

inline AnswerRecord answer(LocalizationStatus status, std::string_view reason) {
  return {.stamp = at(1.0),
          .arrival = at(1.25),
          .localizer = "localizer_1",
          .status = status,
          .reason = reason,
          .applied = status == LocalizationStatus::kLocalized && reason.empty(),
          .innovation = std::nullopt};
}

inline std::vector<std::string> lines_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

inline std::vector<std::string> fields_of(const std::string& line, char separator) {
  std::istringstream stream(line);
  std::vector<std::string> fields;
  for (std::string field; std::getline(stream, field, separator);) fields.push_back(field);
  return fields;
}

/// A run folder of its own for each test, removed with the fixture.
class RunFolderTest : public testing::Test {
 protected:
  RunFolderTest() { std::filesystem::remove_all(folder_); }
  ~RunFolderTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] nlohmann::json summary() const {
    std::ifstream stream(folder_ / "summary.json");
    return nlohmann::json::parse(stream);
  }

  const std::filesystem::path folder_ =
      test_folder() /
      ("fleetloc_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

}  // namespace fleetloc
