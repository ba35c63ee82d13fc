#include "shared/ros2/diagnostics_codec.hpp"

#include <idl/ros2/diagnostic_msgs.h>

#include "shared/ros2/ros2_cdr.hpp"
#include "shared/ros2/ros2_fields.hpp"

namespace fleetloc {
namespace {

using diagnostic_msgs::msg::dds_::DiagnosticStatus_;
using diagnostic_msgs::msg::dds_::KeyValue_;

DiagnosticStatus_ status_to_ros2(const DiagnosticStatus& status) {
  DiagnosticStatus_ message;
  message.level(static_cast<std::uint8_t>(status.level));
  message.name(status.component);
  message.message(status.message);
  message.hardware_id(status.hardware);
  for (const auto& [key, value] : status.values) {
    KeyValue_ pair;
    pair.key(key);
    pair.value(value);
    message.values().push_back(pair);
  }
  return message;
}

}  // namespace

Bytes encode(const DiagnosticsMessage& message) {
  diagnostic_msgs::msg::dds_::DiagnosticArray_ array;
  array.header(to_ros2(message.header));
  for (const DiagnosticStatus& status : message.statuses) {
    array.status().push_back(status_to_ros2(status));
  }
  return to_cdr(array);
}

}  // namespace fleetloc
