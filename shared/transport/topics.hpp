#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <fastdds/dds/topic/TypeSupport.hpp>

#include "shared/link/channel.hpp"

namespace fleetloc {

/// Of all types and names in idl/. It stands in the names of the topics, so that programs of two
/// versions never hear each other; see WireVersionWatch.
inline constexpr int kWireVersion = 2;

/// A topic is a name, a type of idl/ whose samples are given as Bytes, and the name of the QoS
/// profile that its endpoints share; the profile is defined in qos_profiles/, never in code.
struct TopicSpec {
  std::string name;
  std::string qos_profile;
  eprosima::fastdds::dds::TypeSupport type;
  std::string partition = {};  ///< only endpoints of the same one match; empty: none
};

/// `fleetloc/2/<receiver>/submap` and so on; names tell receivers apart, since a discovery server
/// matches by names only.
/// @param receiver  as in Channel::send
TopicSpec topic_spec(Topic topic, const std::string& receiver);

/// `fleetloc/pose`, in the partition of the robot's id. No Channel carries it: it never leaves the
/// robot's computer.
TopicSpec pose_topic_spec(const std::string& robot);

/// `fleetloc/versions`, which every version has and on which nothing is sent: a discovery server
/// tells only those of each other who share a topic.
TopicSpec versions_topic_spec();

/// `fleetloc/2/monitor/robots` and `fleetloc/2/monitor/localizers`: of localizers, for those who
/// watch the fleet. They have participants of their own, see shared/transport/monitoring.
TopicSpec served_robots_topic_spec();
TopicSpec served_localizers_topic_spec();

/// The topic with this name, and its receiver; nothing if topic_spec() makes no such name.
std::optional<std::pair<Topic, std::string>> topic_of(std::string_view name);

/// The topic with this name; `fleetloc/pose` of all robots.
std::optional<TopicSpec> topic_spec_of(std::string_view name);

}  // namespace fleetloc
