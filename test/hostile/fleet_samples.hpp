#pragma once

#include <string>
#include <vector>

#include "deploy/config/default_config.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/link/channel.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/answer_bytes.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {

// What the ends of a fleet say to each other: well-formed, and no more than that.

inline constexpr Incarnation kIncarnation{3};

inline RobotSession session_for(const RobotId& robot,
                                std::uint32_t number = 1,
                                Timestamp start = {}) {
  RobotSession session;
  session.robot = robot;
  session.session = SessionNumber{number};
  session.start_stamp = start;
  session.localizer = "cloud_1";
  session.incarnation = kIncarnation;
  session.stereo = {
      .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.1, .T_body_cam0 = {}};
  return session;
}

inline Submap submap_of(const RobotId& robot, std::uint32_t number, std::uint32_t session = 1) {
  Submap submap;
  submap.robot = robot;
  submap.session = SessionNumber{session};
  submap.incarnation = kIncarnation;
  submap.number = SampleNumber{number};
  submap.keyframes.push_back({.id = KeyframeId{number},
                              .revision = Revision{1},
                              .stamp = at_ms(static_cast<int>(number)),
                              .T_odom_body = {},
                              .tilt_sigma = 0.01,
                              .observations = {}});
  return submap;
}

inline LocalizerStatus status_of(const std::string& localizer,
                                 Incarnation incarnation = kIncarnation) {
  return {.localizer = localizer,
          .incarnation = incarnation,
          .map_hash = {},
          .load = 0.1,
          .accepting = true};
}

inline LocalizationResult answer_of(const std::string& localizer,
                                    std::uint32_t keyframe,
                                    Incarnation incarnation = kIncarnation) {
  LocalizationResult answer;
  answer.robot = "robot_1";
  answer.session = SessionNumber{1};
  answer.localizer = localizer;
  answer.incarnation = incarnation;
  answer.status = LocalizationStatus::kTooFewMatches;
  answer.keyframe = KeyframeId{keyframe};
  answer.revision = Revision{1};
  answer.stamp = at_ms(1);
  return answer;
}

inline Message as_message(const RobotSession& session) {
  return {.topic = Topic::kSession, .payload = encode(session)};
}
inline Message as_message(const Submap& submap) {
  return {.topic = Topic::kSubmap, .payload = encode(submap)};
}
inline Message as_message(const LocalizerStatus& status) {
  return {.topic = Topic::kLocalizerStatus, .payload = encode(status)};
}
inline Message as_message(const LocalizationResult& answer) {
  return {.topic = Topic::kLocalization, .payload = encode(answer)};
}

}  // namespace fleetloc
