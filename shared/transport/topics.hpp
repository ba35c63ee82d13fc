#pragma once

#include <string>

#include <fastdds/dds/topic/TypeSupport.hpp>

#include "shared/link/channel.hpp"

namespace fleetloc {

/// A topic is a name, a type of idl/ whose samples are given as Bytes, and the name of the QoS
/// profile that its endpoints share; the profile is defined in qos_profiles/, never in code.
struct TopicSpec {
  std::string name;
  std::string qos_profile;
  eprosima::fastdds::dds::TypeSupport type;
};

TopicSpec topic_spec(Topic topic);

/// `fleetloc/pose`, which no Channel carries: it never leaves the robot's computer.
TopicSpec pose_topic_spec();

}  // namespace fleetloc
