#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cloud/pool/localizer_pool.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/answer_bytes.hpp"
#include "test/pipeline/simulated_system.hpp"
#include "test/unit/timestamps.hpp"

namespace fleetloc {

inline RobotSession session_of(const RobotId& robot, double start_s = 1.0) {
  RobotSession session;
  session.robot = robot;
  session.session = SessionNumber{static_cast<std::uint32_t>(10.0 * start_s)};
  session.start_stamp = at(start_s);
  session.localizer = "localizer";
  session.incarnation = Incarnation{3};
  session.stereo = {
      .focal_px = 450.0, .center_px = {1024.0, 1024.0}, .baseline_m = 0.1, .T_body_cam0 = {}};
  return session;
}

inline Submap submap_of(const RobotSession& session, std::uint32_t number) {
  Submap submap;
  submap.robot = session.robot;
  submap.session = session.session;
  submap.incarnation = session.incarnation;
  submap.number = SampleNumber{number};
  submap.keyframes.push_back({.id = KeyframeId{number},
                              .revision = Revision{1},
                              .stamp = Timestamp{Duration{number}},
                              .T_odom_body = {},
                              .tilt_sigma = 0.01,
                              .observations = {}});
  return submap;
}

/// One localizer and many robots whose submaps are empty.
class ManyRobots : public testing::Test {
 protected:
  static LocalizerPool::Config config() { return read_localizer_pool_config(defaults()); }

  void open(const RobotSession& session, double s) {
    pool_.receive({Topic::kSession, encode(session)}, at(s));
  }
  void send(const Submap& submap, double s) {
    pool_.receive({Topic::kSubmap, encode(submap)}, at(s));
  }
  std::vector<LocalizationResult> answers(double s) {
    std::vector<LocalizationResult> answers;
    for (const auto& outgoing : pool_.outgoing(at(s), 0.0)) {
      if (outgoing.message.topic != Topic::kLocalization) continue;
      answers.push_back(decode_localization_result(outgoing.message.payload).value());
      EXPECT_EQ(outgoing.partition, answers.back().robot);
    }
    return answers;
  }
  std::uint64_t refused(const RobotId& robot, const std::string& reason) {
    const auto counts = pool_.reports().at(robot).refused;
    return counts.contains(reason) ? counts.at(reason) : 0;
  }

  std::shared_ptr<const LaserMap> map_ =
      std::make_shared<const LaserMap>(build_map({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}},
                                                 "map",
                                                 read_map_config(defaults().section("map"))));
  LocalizerPool pool_{"localizer", Incarnation{3}, map_, config()};
};

/// Robots that send twice a second, and workers whose jobs take as long as each robot's do.

}  // namespace fleetloc
