#include "test/ros2/cyclone_entity.hpp"

#include <ctime>
#include <memory>
#include <stdexcept>

namespace fleetloc {
namespace {

using Qos = std::unique_ptr<dds_qos_t, decltype(&dds_delete_qos)>;

Qos profile(RosQos kind) {
  constexpr int kSensorDataDepth = 5;
  constexpr int kDefaultDepth = 10;
  const bool is_reliable = kind == RosQos::kDefault;
  Qos qos(dds_create_qos(), dds_delete_qos);
  dds_qset_reliability(qos.get(),
                       is_reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_INFINITY);
  dds_qset_durability(qos.get(), DDS_DURABILITY_VOLATILE);
  dds_qset_history(
      qos.get(), DDS_HISTORY_KEEP_LAST, is_reliable ? kDefaultDepth : kSensorDataDepth);
  return qos;
}

}  // namespace

dds_return_t checked(dds_return_t result, const std::string& what) {
  if (result < 0) throw std::runtime_error(what + ": " + dds_strretcode(result));
  return result;
}

dds_entity_t ros_topic(dds_entity_t participant,
                       const dds_topic_descriptor_t& type,
                       const std::string& name) {
  return checked(dds_create_topic(participant, &type, ("rt" + name).c_str(), nullptr, nullptr),
                 name);
}

dds_entity_t ros_writer(dds_entity_t participant, dds_entity_t topic, RosQos qos) {
  return checked(dds_create_writer(participant, topic, profile(qos).get(), nullptr), "writer");
}

dds_entity_t ros_reader(dds_entity_t participant, dds_entity_t topic, RosQos qos) {
  return checked(dds_create_reader(participant, topic, profile(qos).get(), nullptr), "reader");
}

std::int64_t boot_time_ns() {
  constexpr std::int64_t kPerSecond = 1'000'000'000;
  timespec time{};
  clock_gettime(CLOCK_BOOTTIME, &time);
  return time.tv_sec * kPerSecond + time.tv_nsec;
}

}  // namespace fleetloc
