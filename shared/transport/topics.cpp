#include "shared/transport/topics.hpp"

#include <stdexcept>

#include <idl/compact_submapPubSubTypes.h>
#include <idl/localizationPubSubTypes.h>
#include <idl/posePubSubTypes.h>
#include <idl/sessionPubSubTypes.h>
#include <idl/statusPubSubTypes.h>
#include <idl/submapPubSubTypes.h>

#include "shared/transport/bytes_type.hpp"

namespace fleetloc {
namespace {

template <typename PubSubType>
TopicSpec spec(const std::string& name) {
  TopicSpec spec{.name = "fleetloc/" + name, .qos_profile = name, .type = {}};
  spec.type.reset(new BytesType(PubSubType()));
  return spec;
}

}  // namespace

TopicSpec topic_spec(Topic topic) {
  switch (topic) {
    case Topic::kSession:
      return spec<wire::RobotSessionPubSubType>("session");
    case Topic::kSubmap:
      return spec<wire::SubmapPubSubType>("submap");
    case Topic::kCompactSubmap:
      return spec<wire::CompactSubmapPubSubType>("compact_submap");
    case Topic::kLocalization:
      return spec<wire::LocalizationResultPubSubType>("localization");
    case Topic::kRobotStatus:
      return spec<wire::RobotStatusPubSubType>("robot_status");
    case Topic::kLocalizerStatus:
      return spec<wire::LocalizerStatusPubSubType>("localizer_status");
  }
  throw std::logic_error("no such topic");
}

TopicSpec pose_topic_spec() {
  return spec<wire::PoseEstimatePubSubType>("pose");
}

}  // namespace fleetloc
