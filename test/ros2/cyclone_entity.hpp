#pragma once

#include <cstdint>
#include <string>

#include <dds/dds.h>

namespace fleetloc {

// Eclipse Cyclone DDS by its C interface: a node of ROS 2 whose DDS is of another vendor than ours.
// Its network is what CYCLONEDDS_URI says.

/// Throws std::runtime_error if Cyclone has returned an error.
dds_return_t checked(dds_return_t result, const std::string& what);

/// An entity of Cyclone, deleted with what was created in it.
class CycloneEntity {
 public:
  /// @param entity  or an error of Cyclone: std::runtime_error
  CycloneEntity(dds_entity_t entity, const std::string& what) : entity_(checked(entity, what)) {}
  ~CycloneEntity() { dds_delete(entity_); }
  CycloneEntity(const CycloneEntity&) = delete;
  CycloneEntity& operator=(const CycloneEntity&) = delete;
  operator dds_entity_t() const { return entity_; }

 private:
  dds_entity_t entity_;
};

/// The profiles of ROS 2.
enum class RosQos {
  kSensorData,  ///< best effort
  kDefault,     ///< reliable
};

/// @param name  as ROS writes it, e.g. "/imu"
dds_entity_t ros_topic(dds_entity_t participant,
                       const dds_topic_descriptor_t& type,
                       const std::string& name);
dds_entity_t ros_writer(dds_entity_t participant, dds_entity_t topic, RosQos qos);
dds_entity_t ros_reader(dds_entity_t participant, dds_entity_t topic, RosQos qos);

/// CLOCK_BOOTTIME: one clock for all processes [ns].
std::int64_t boot_time_ns();

}  // namespace fleetloc
