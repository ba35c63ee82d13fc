#include "shared/transport/topics.hpp"

#include <array>
#include <stdexcept>

#include <idl/compact_submapPubSubTypes.h>
#include <idl/localizationPubSubTypes.h>
#include <idl/monitoringPubSubTypes.h>
#include <idl/posePubSubTypes.h>
#include <idl/sessionPubSubTypes.h>
#include <idl/statusPubSubTypes.h>
#include <idl/submapPubSubTypes.h>

#include "shared/transport/bytes_type.hpp"

namespace fleetloc {
namespace {

template <typename PubSubType>
TopicSpec spec(const std::string& name, const std::string& qos_profile) {
  TopicSpec spec{.name = name, .qos_profile = qos_profile, .type = {}};
  spec.type.reset(new BytesType(PubSubType()));
  return spec;
}

const std::string kPrefix = "fleetloc/" + std::to_string(kWireVersion) + "/";
constexpr const char* kPose = "fleetloc/pose";
constexpr std::array kTopics{Topic::kSession,
                             Topic::kSubmap,
                             Topic::kCompactSubmap,
                             Topic::kLocalization,
                             Topic::kRobotStatus,
                             Topic::kLocalizerStatus};

template <typename PubSubType>
TopicSpec to(const std::string& receiver, const std::string& topic, const std::string& qos) {
  return spec<PubSubType>(kPrefix + receiver + "/" + topic, qos);
}
template <typename PubSubType>
TopicSpec to(const std::string& receiver, const std::string& topic) {
  return to<PubSubType>(receiver, topic, topic);
}

}  // namespace

TopicSpec topic_spec(Topic topic, const std::string& receiver) {
  switch (topic) {
    case Topic::kSession:
      return to<wire::RobotSessionPubSubType>(receiver, "session");
    case Topic::kSubmap:
      return to<wire::SubmapPubSubType>(receiver, "full_submap", "submap");
    case Topic::kCompactSubmap:
      return to<wire::CompactSubmapPubSubType>(receiver, "submap");
    case Topic::kLocalization:
      return to<wire::LocalizationResultPubSubType>(receiver, "localization");
    case Topic::kRobotStatus:
      return to<wire::RobotStatusPubSubType>(receiver, "robot_status");
    case Topic::kLocalizerStatus:
      return spec<wire::LocalizerStatusPubSubType>(kPrefix + "localizers", "localizers");
  }
  throw std::logic_error("no such topic");
}

TopicSpec pose_topic_spec(const std::string& robot) {
  TopicSpec pose = spec<wire::PoseEstimatePubSubType>(kPose, "pose");
  pose.partition = robot;
  return pose;
}

TopicSpec versions_topic_spec() {
  return spec<wire::LocalizerStatusPubSubType>("fleetloc/versions", "robot_status");
}

TopicSpec served_robots_topic_spec() {
  return spec<wire::ServedRobotPubSubType>(kPrefix + "monitor/robots", "monitor_robots");
}

TopicSpec served_localizers_topic_spec() {
  return spec<wire::LocalizerStatusPubSubType>(kPrefix + "monitor/localizers",
                                               "monitor_localizers");
}

std::optional<std::pair<Topic, std::string>> topic_of(std::string_view name) {
  if (!name.starts_with(kPrefix)) return std::nullopt;
  const std::string_view rest = name.substr(kPrefix.size());
  const std::string receiver(rest.substr(0, rest.find('/')));
  for (const Topic topic : kTopics) {
    if (topic_spec(topic, receiver).name != name) continue;
    return std::pair(topic, topic == Topic::kLocalizerStatus ? std::string() : receiver);
  }
  return std::nullopt;
}

std::optional<TopicSpec> topic_spec_of(std::string_view name) {
  if (name == kPose) return pose_topic_spec("*");
  const auto topic = topic_of(name);
  return topic ? std::optional(topic_spec(topic->first, topic->second)) : std::nullopt;
}

}  // namespace fleetloc
