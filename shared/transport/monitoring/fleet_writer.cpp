#include "shared/transport/monitoring/fleet_writer.hpp"

#include <fastdds/dds/core/status/PublicationMatchedStatus.hpp>

#include "shared/wire/served_robot_codec.hpp"
#include "shared/wire/status_codec.hpp"

namespace fleetloc {

FleetWriter::FleetWriter(std::uint32_t domain, const std::optional<FleetKeys>& keys)
    : participant_(domain, "monitored", nullptr, {.keys = keys}),
      robots_(participant_.create_writer(served_robots_topic_spec())),
      localizers_(participant_.create_writer(served_localizers_topic_spec())) {}

bool FleetWriter::is_watched() const {
  eprosima::fastdds::dds::PublicationMatchedStatus matched;
  localizers_->get_publication_matched_status(matched);
  return matched.current_count > 0;
}

// What is beyond the range of the wire is left out.
void FleetWriter::write(const LocalizerStatus& localizer, const std::vector<ServedRobot>& robots) {
  const auto write = [](auto& writer, const auto& sample) {
    try {
      Bytes bytes = encode(sample);
      writer->write(&bytes);
    } catch (const NotEncodable&) {
    }
  };
  write(localizers_, localizer);
  for (const ServedRobot& robot : robots) write(robots_, robot);
}

}  // namespace fleetloc
