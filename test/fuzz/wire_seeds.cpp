#include "shared/compact/answer_sample.hpp"
#include "shared/compact/submap_sample.hpp"
#include "shared/wire/pose_codec.hpp"
#include "shared/wire/served_robot_codec.hpp"
#include "shared/wire/session_codec.hpp"
#include "shared/wire/status_codec.hpp"
#include "shared/wire/submap_codec.hpp"
#include "test/fuzz/seeds.hpp"
#include "test/unit/compact/moving_robot.hpp"
#include "test/unit/wire/samples.hpp"

namespace fleetloc {
namespace {

Bytes behind(std::uint8_t first, const Bytes& bytes) {
  Bytes all{first};
  all.insert(all.end(), bytes.begin(), bytes.end());
  return all;
}

/// With its topic, as the target of a tool has them.
void add_sample(const SeedFolder& seeds,
                const std::string& target,
                std::uint8_t topic,
                const std::string& name,
                const Bytes& sample) {
  seeds.add(target, name, sample);
  seeds.add("net_topic_sample", target + "_" + name, behind(topic, sample));
}

void add_sessions(const SeedFolder& seeds) {
  RobotSession session = some_session();
  add_sample(seeds, "net_session", 0, "full", encode(session));
  session.encoding = SubmapEncoding::kCompact;
  session.start.reset();
  add_sample(seeds, "net_session", 0, "without_start", encode(session));
  session.region = StartRegion{.name = "hall", .center_map = {1.0, 2.0}, .radius_m = 5.0};
  add_sample(seeds, "net_session", 0, "region", encode(session));
}

void add_submaps(const SeedFolder& seeds) {
  for (const auto& [keyframes, observations] : {std::pair(1, 0), {3, 5}, {8, 40}}) {
    const std::string name = std::to_string(keyframes) + "_keyframes";
    add_sample(seeds, "net_submap", 1, name, encode(some_submap(keyframes, observations)));
  }
  for (const int keyframes : {1, 3, 8}) {
    for (const std::uint32_t step_bits : {0U, 1U, 7U}) {
      const std::string name =
          std::to_string(keyframes) + "_keyframes_" + std::to_string(step_bits);
      const Bytes sample = encode_compact(moving_robot(100, keyframes),
                                          {.newest = 7, .loss = 0.5, .age = Duration(5'000'000)},
                                          {.subset = {}, .step_bits = step_bits},
                                          some_stereo());
      seeds.add("net_compact_submap", name, behind(0, sample));
      seeds.add("net_topic_sample", "net_compact_submap_" + name, behind(2, sample));
    }
  }
}

void add_answers(const SeedFolder& seeds) {
  LocalizationResult answer = some_answer();
  add_sample(seeds, "net_answer", 3, "localized", encode(Answer{answer, {}}, 1200));
  add_sample(seeds, "net_answer", 3, "corrected", encode(Answer{answer, some_correction()}, 1200));
  add_sample(seeds, "net_answer", 3, "cut", encode(Answer{answer, some_correction(60)}, 400));
  answer.status = LocalizationStatus::kAmbiguous;
  answer.places = 3;
  add_sample(seeds, "net_answer", 3, "ambiguous", encode(Answer{answer, {}}, 1200));
}

void add_statuses(const SeedFolder& seeds) {
  add_sample(seeds, "net_robot_status", 4, "some", encode(some_robot_status()));
  add_sample(seeds, "net_localizer_status", 5, "some", encode(some_localizer_status()));
  RobotPoseEstimate pose = some_pose_estimate();
  add_sample(seeds, "net_pose", 6, "in_the_map", encode(pose));
  pose.estimate.T_map_body.reset();
  add_sample(seeds, "net_pose", 6, "odometry", encode(pose));
  ServedRobot robot{.localizer = "cloud", .robot = "robot_1", .T_map_body = some_pose(1.0)};
  robot.possible_places = {{1.0, 2.0, 3.0}, {-4.0, 5.0, 6.0}};
  seeds.add("net_served_robot", "some", encode(robot));
  seeds.add("net_sample_key", "robot_status", encode(some_robot_status()));
  seeds.add("net_sample_key", "session", encode(some_session()));
}

}  // namespace

void add_wire_seeds(const SeedFolder& seeds) {
  add_sessions(seeds);
  add_submaps(seeds);
  add_answers(seeds);
  add_statuses(seeds);
}

}  // namespace fleetloc
