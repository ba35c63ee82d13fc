#include "shared/transport/ros2/ros2_participant.hpp"

#include <algorithm>
#include <utility>

#include <fastdds/dds/core/status/PublicationMatchedStatus.hpp>
#include <fastdds/dds/core/status/SubscriptionMatchedStatus.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "shared/core/boot_time.hpp"
#include "shared/transport/bytes_type.hpp"

namespace fleetloc {

namespace dds = eprosima::fastdds::dds;

namespace {

constexpr const char* kProfile = "ros2";

// Of other vendors, too. The largest sample: an rgb8 image of 22 million pixels.
constexpr RtpsLimits kLimits{.largest_sample_bytes = 64U << 20U, .allows_extensions = true};

std::string profile_of(Ros2Qos qos) {
  switch (qos) {
    case Ros2Qos::kSensorData:
      return "ros2_sensor_data";
    case Ros2Qos::kDefault:
      return "ros2_default";
    case Ros2Qos::kLatched:
      return "ros2_latched";
  }
  return "";
}

TopicSpec spec_of(const Ros2Topic& topic) {
  TopicSpec spec{.name = topic.name, .qos_profile = profile_of(topic.qos), .type = {}};
  spec.type.reset(new BytesType(topic.type));
  return spec;
}

std::vector<std::size_t> capacities(const std::vector<Ros2Subscription>& subscriptions) {
  std::vector<std::size_t> capacities;
  for (const auto& subscription : subscriptions) capacities.push_back(subscription.capacity);
  return capacities;
}

std::vector<EntityPtr<dds::DataReader>> created(Ros2Participant& participant,
                                                const std::vector<Ros2Subscription>& wanted) {
  std::vector<EntityPtr<dds::DataReader>> readers;
  for (const auto& one : wanted) readers.push_back(participant.create_reader(one.topic));
  return readers;
}

std::vector<dds::DataReader*> pointers(const std::vector<EntityPtr<dds::DataReader>>& readers) {
  std::vector<dds::DataReader*> pointers;
  for (const auto& reader : readers) pointers.push_back(reader.get());
  return pointers;
}

}  // namespace

int Ros2Writer::matched_readers() const {
  dds::PublicationMatchedStatus matched;
  writer_->get_publication_matched_status(matched);
  return matched.current_count;
}

bool Ros2Writer::wait_for_acknowledgments(std::chrono::milliseconds max_wait) {
  const auto limit = eprosima::fastrtps::Duration_t(1e-3 * static_cast<double>(max_wait.count()));
  return writer_->wait_for_acknowledgments(limit) == ReturnCode_t::RETCODE_OK;
}

Ros2Participant::Ros2Participant(std::uint32_t domain)
    : participant_(domain, kProfile, nullptr, {.limits = kLimits}) {}

Ros2Writer Ros2Participant::create_writer(const Ros2Topic& topic) {
  return Ros2Writer(participant_.create_writer(spec_of(topic)));
}

EntityPtr<dds::DataReader> Ros2Participant::create_reader(const Ros2Topic& topic) {
  return participant_.create_reader(spec_of(topic));
}

Ros2Reader::Ros2Reader(Ros2Participant& participant,
                       const std::vector<Ros2Subscription>& subscriptions)
    : arrivals_(capacities(subscriptions)),
      readers_(created(participant, subscriptions)),
      thread_(pointers(readers_), [this](dds::DataReader& reader) { return take_from(reader); }) {}

int Ros2Reader::matched_writers(std::size_t subscription) const {
  dds::SubscriptionMatchedStatus matched;
  readers_.at(subscription)->get_subscription_matched_status(matched);
  return matched.current_count;
}

bool Ros2Reader::take_from(dds::DataReader& reader) {
  const auto its = std::ranges::find(readers_, &reader, &EntityPtr<dds::DataReader>::get);
  Ros2Sample sample{.topic = static_cast<std::size_t>(its - readers_.begin()),
                    .payload = {},
                    .arrival = boot_time()};
  dds::SampleInfo info;
  if (reader.take_next_sample(&sample.payload, &info) != ReturnCode_t::RETCODE_OK) return false;
  if (info.valid_data) arrivals_.push(std::move(sample));
  return true;
}

}  // namespace fleetloc
