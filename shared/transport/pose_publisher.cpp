#include "shared/transport/pose_publisher.hpp"

#include <fastdds/dds/core/status/PublicationMatchedStatus.hpp>

namespace fleetloc {

PosePublisher::PosePublisher(std::uint32_t domain,
                             const std::string& robot,
                             const std::string& participant_profile)
    : participant_(domain, participant_profile),
      writer_(participant_.create_writer(pose_topic_spec(robot))) {}

bool PosePublisher::publish(Bytes pose) {
  return writer_->write(&pose);
}

int PosePublisher::matched_readers() {
  eprosima::fastdds::dds::PublicationMatchedStatus status;
  writer_->get_publication_matched_status(status);
  return status.current_count;
}

}  // namespace fleetloc
