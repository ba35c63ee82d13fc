#pragma once

#include <memory>

#include <gtest/gtest.h>

#include "deploy/config/default_config.hpp"
#include "robot/cloud_client/cloud_client.hpp"
#include "shared/config/config_reader.hpp"
#include "shared/link/memory_network.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/answer_bytes.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {

inline Submap bare_submap(std::uint32_t keyframe) {
  Submap submap;
  submap.keyframes.push_back({.id = KeyframeId{keyframe},
                              .revision = Revision{1},
                              .stamp = at_ms(1),
                              .T_odom_body = {},
                              .tilt_sigma = 0.01,
                              .observations = {}});
  return submap;
}

inline RobotSession bare_session() {
  RobotSession session;
  session.robot = "robot";
  session.session = SessionNumber{1};
  session.stereo = {
      .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.1, .T_body_cam0 = {}};
  return session;
}

/// A client, and the bare ends of two localizers.
class CloudClientTest : public testing::Test {
 protected:
  static void announce(
      Channel& end, const std::string& name, double load, int ms, bool accepting = true) {
    end.send("",
             {Topic::kLocalizerStatus,
              encode(LocalizerStatus{.localizer = name,
                                     .incarnation = Incarnation{1},
                                     .map_hash = {},
                                     .sessions = 0,
                                     .load = load,
                                     .accepting = accepting})},
             at_ms(ms));
  }

  static void drain(Channel& end, const std::string& name, int ms) {
    end.send("",
             {Topic::kLocalizerStatus,
              encode(LocalizerStatus{
                  .localizer = name, .incarnation = Incarnation{1}, .draining = true})},
             at_ms(ms));
  }

  static LocalizationResult answer(const std::string& localizer, std::uint32_t keyframe) {
    LocalizationResult answer;
    answer.robot = "robot";
    answer.session = SessionNumber{1};
    answer.localizer = localizer;
    answer.incarnation = Incarnation{1};
    answer.status = LocalizationStatus::kTooFewMatches;
    answer.keyframe = KeyframeId{keyframe};
    answer.revision = Revision{1};
    answer.stamp = at_ms(1);
    return answer;
  }

  static Correction correction(const std::string& localizer, std::uint32_t anchor) {
    Correction correction;
    correction.robot = "robot";
    correction.session = SessionNumber{1};
    correction.localizer = localizer;
    correction.incarnation = Incarnation{1};
    correction.anchor = KeyframeId{anchor};
    correction.landmarks.push_back({LandmarkId{1}, {1.0, 2.0, 3.0}, Eigen::Matrix3d::Identity()});
    return correction;
  }

  /// A localized answer that brings them.
  void send(const Correction& correction, int ms) {
    LocalizationResult localized =
        answer(correction.localizer, static_cast<std::uint32_t>(correction.anchor));
    localized.robot = correction.robot;
    localized.session = correction.session;
    localized.incarnation = correction.incarnation;
    idle_->send(
        "robot", {Topic::kLocalization, encode(Answer{localized, correction}, 1200)}, at_ms(ms));
  }

  static int count(const std::vector<Message>& messages, Topic topic) {
    return static_cast<int>(std::ranges::count(messages, topic, &Message::topic));
  }

  MemoryNetwork network_{perfect_link()};
  std::unique_ptr<Channel> robot_end_ = network_.join_robot("robot");
  std::unique_ptr<Channel> busy_ = network_.join_cloud("busy");
  std::unique_ptr<Channel> idle_ = network_.join_cloud("idle");
  CloudClient client_{"robot",
                      *robot_end_,
                      read_cloud_client_config(
                          ConfigReader::from_string(default_config("robot")).section("client"))};
};

}  // namespace fleetloc
