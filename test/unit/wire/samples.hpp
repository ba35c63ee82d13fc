#pragma once

#include <functional>

#include <gtest/gtest.h>

#include "shared/geometry/so3.hpp"
#include "shared/model/correction.hpp"
#include "shared/model/localization_result.hpp"
#include "shared/model/robot_status.hpp"
#include "shared/model/session.hpp"
#include "shared/model/submap.hpp"
#include "shared/wire/cdr.hpp"
#include "shared/wire/pose_codec.hpp"

namespace fleetloc {

inline Pose some_pose(double seed) {
  return {exp_so3({0.3 * seed, -0.2 + seed, 0.7}), {3.0 + seed, -1.0, 0.5 * seed}};
}

/// Positive definite, with the scales of a rotation and a translation.
inline Matrix6d some_matrix() {
  Matrix6d root = Matrix6d::Zero();
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) root(i, j) = (i < 3 ? 700.0 : 30.0) / (1.0 + 2.0 * (j - i));
  }
  return root.transpose() * root;
}

/// As a robot would send it: `keyframes` with `observations` each, tracks of eight keyframes.
inline Submap some_submap(int keyframes = 3, int observations = 5) {
  Submap submap{.robot = "robot_1",
                .session = SessionNumber{2},
                .incarnation = Incarnation{3},
                .number = SampleNumber{4'000'000'000},
                .keyframes = {},
                .edges = {},
                .landmarks = {}};
  for (int k = 0; k < keyframes; ++k) {
    SubmapKeyframe keyframe{
        .id = KeyframeId{static_cast<std::uint32_t>(100 + 2 * k)},
        .revision = Revision{static_cast<std::uint32_t>(k + 1)},
        .stamp = Timestamp{Duration{1'403'636'579'763'555'584 + k * std::int64_t{500'000'001}}},
        .T_odom_body = some_pose(0.1 * k),
        .tilt_sigma = 0.004,
        .observations = {}};
    for (int i = 0; i < observations; ++i) {
      const int row = k * observations / 8 + i;
      keyframe.observations.push_back(
          {.landmark = LandmarkId{static_cast<std::uint32_t>(70'000 + 3 * row)},
           .left = {row % 700 + 0.25, 2.0 * i + 0.5},
           .disparity = i % 10 == 0 ? 0.0 : 0.5 + i % 40});
    }
    submap.keyframes.push_back(keyframe);
  }
  for (int row = 0; row < (keyframes - 1) * observations / 8 + observations; ++row) {
    submap.landmarks.push_back({LandmarkId{static_cast<std::uint32_t>(70'000 + 3 * row)},
                                {1.0 + 0.1 * row, -2.0, 5.0 / (1.0 + row)}});
  }
  for (int k = 0; k + 1 < keyframes; ++k) {
    submap.edges.push_back({.from = submap.keyframes[static_cast<std::size_t>(k)].id,
                            .to = submap.keyframes[static_cast<std::size_t>(k) + 1].id,
                            .revision = Revision{7},
                            .T_from_to = some_pose(0.05 * k),
                            .information = some_matrix()});
  }
  return submap;
}

inline RobotSession some_session() {
  return {.robot = "robot_1",
          .session = SessionNumber{4'294'967'295},
          .start_stamp = Timestamp{Duration{1'403'636'579'763'555'584}},
          .localizer = "cloud-with-a-name-of-32-characte",
          .incarnation = Incarnation{4'000'000'000},
          .encoding = SubmapEncoding::kFull,
          .stereo = {.focal_px = 458.654,
                     .center_px = {1024.0, 1024.0},
                     .baseline_m = 0.11,
                     .T_body_cam0 = some_pose(0.3)},
          .start = MapOdomEstimate{.T_map_odom = some_pose(4.0),
                                   .covariance = some_matrix(),
                                   .p_odom = {40.0, -50.0, 0.5}},
          .region = std::nullopt};
}

inline LocalizationResult some_answer() {
  return {.robot = "robot_1",
          .session = SessionNumber{2},
          .localizer = "cloud-a",
          .incarnation = Incarnation{17},
          .number = 9,
          .acknowledgements = {.base = SampleNumber{5}, .bitmap = 0xF0F0'F0F0'0000'0001},
          .status = LocalizationStatus::kLocalized,
          .keyframe = KeyframeId{100'000},
          .revision = Revision{2},
          .stamp = Timestamp{Duration{-5}},
          .oldest_stamp = Timestamp{Duration{-20'000'000'000}},
          .map_hash = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 255},
          .T_map_body = some_pose(1.0),
          .covariance = some_matrix() * 1e-10,
          .holding_time = Duration{12'345'678}};
}

/// Seven relative poses, and landmarks on planes: information of rank one and of full rank.
inline Correction some_correction(int landmarks = 20, std::uint32_t gap = 3) {
  Correction correction;
  correction.robot = "robot_1";
  correction.session = SessionNumber{2};
  correction.localizer = "cloud-a";
  correction.incarnation = Incarnation{17};
  correction.anchor = KeyframeId{100'000};
  for (std::uint32_t i = 0; i < 7; ++i) {
    correction.relative_poses.push_back({.from = KeyframeId{99'986 + 2 * i},
                                         .to = KeyframeId{99'988 + 2 * i},
                                         .T_from_to = some_pose(0.01 * i),
                                         .information = some_matrix()});
  }
  for (int i = 0; i < landmarks; ++i) {
    const Eigen::Vector3d normal = Eigen::Vector3d(1.0, 0.3 * i, -0.2).normalized();
    correction.landmarks.push_back({.id = LandmarkId{70'000 + gap * static_cast<std::uint32_t>(i)},
                                    .p_anchor = {3.0 + 0.1 * i, -2.0, 60.0 - i},
                                    .information = 100.0 * i * normal * normal.transpose() +
                                                   (i % 2) * 40.0 * Eigen::Matrix3d::Identity()});
  }
  return correction;
}

inline LocalizerStatus some_localizer_status() {
  return {.localizer = "cloud-a",
          .incarnation = Incarnation{17},
          .map_hash = {9, 8, 7},
          .sessions = 31,
          .load = 0.25,
          .accepting = true};
}

inline RobotStatus some_robot_status() {
  return {.robot = "robot_1",
          .session = SessionNumber{2},
          .start_stamp = Timestamp{Duration{1'403'636'579'763'555'584}},
          .stamp = Timestamp{Duration{77}},
          .quality = Quality::kDeadReckoning,
          .submaps_sent = 5'000'000'000,
          .answers_applied = 4'999'999'999,
          .round_trip = Duration{123'456'789}};
}

inline RobotPoseEstimate some_pose_estimate() {
  return {.robot = "robot_1",
          .estimate = {.stamp = Timestamp{Duration{1'403'636'579'763'555'584}},
                       .quality = Quality::kLocalized,
                       .since_last_answer = Duration{1'500'000'000},
                       .T_odom_body = some_pose(0.7),
                       .covariance_odom = some_matrix() * 1e-9,
                       .T_map_body = some_pose(0.9),
                       .covariance_map = some_matrix() * 1e-8,
                       .v_odom = {1.0, -2.0, 0.125},
                       .angular_velocity = {0.1, 0.2, 0.3}}};
}

inline void expect_near(const Pose& a, const Pose& b, double rad, double m) {
  EXPECT_LE(local_coordinates(a, b).head<3>().norm(), rad);
  EXPECT_LE((a.p - b.p).cwiseAbs().maxCoeff(), m);
}

/// Each entry relative to the square roots of its diagonal entries.
inline void expect_near(const Matrix6d& a, const Matrix6d& b, double relative) {
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      EXPECT_NEAR(a(i, j), b(i, j), relative * std::sqrt(b(i, i) * b(j, j)));
    }
  }
}

/// Encodes `sent`, lets `corrupt` change the sample on the wire, and expects that `decode` refuses
/// it for `reason`.
template <typename Sample, typename Sent, typename Decode>
void expect_refused(const Sent& sent,
                    Decode decode,
                    Malformed reason,
                    const std::function<void(Sample&)>& corrupt) {
  auto sample = from_cdr<Sample>(encode(sent), 0).value();
  corrupt(sample);
  const auto decoded = decode(to_cdr(sample));
  ASSERT_FALSE(decoded.has_value()) << "expected " << name(reason);
  EXPECT_EQ(name(decoded.error()), name(reason));
}

}  // namespace fleetloc
