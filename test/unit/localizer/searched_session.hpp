#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "cloud/localizer/session_localizer.hpp"
#include "simulated_session.hpp"

namespace fleetloc {

inline RobotSession without_start(const SimulatedSession& robot) {
  RobotSession session = robot.session();
  session.start.reset();
  return session;
}

/// An answer to keyframe `i`, after all turns of a search that it begins.
inline LocalizationResult answer_to(SessionLocalizer& localizer,
                                    const SimulatedSession& robot,
                                    int i) {
  localizer.add(robot.submap(i));
  LocalizationResult answer = localizer.localize();
  while (localizer.is_searching()) answer = localizer.localize();
  return answer;
}

/// Whether one of the places where a robot may be is its own: they are aligned after each metre.
inline bool has_truth(const std::vector<PlaceHypotheses::Place>& places, const Pose& truth) {
  return std::ranges::any_of(places, [&truth](const PlaceHypotheses::Place& place) {
    return (place.T_map_body.p - truth.p).norm() < 1.5;
  });
}

/// The first keyframe that is localized, if one of the first `count` is.
inline std::optional<int> first_localized(SessionLocalizer& localizer,
                                          const SimulatedSession& robot,
                                          int count) {
  for (int i = 0; i < count; ++i) {
    const LocalizationResult answer = answer_to(localizer, robot, i);
    if (answer.status != LocalizationStatus::kLocalized) continue;
    EXPECT_LT(position_error(answer, robot.truth(i)), 0.25) << "keyframe " << i;
    EXPECT_LT(rotation_error(answer, robot.truth(i)), 0.03) << "keyframe " << i;
    return i;
  }
  return std::nullopt;
}

/// With a start pose that is known to these sigmas only.
inline RobotSession with_start(const SimulatedSession& robot, double sigma_m, double sigma_rad) {
  RobotSession session = robot.session();
  session.start->covariance = diagonal_covariance(sigma_rad, sigma_m);
  return session;
}

}  // namespace fleetloc
