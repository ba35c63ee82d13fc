#include "shared/transport/monitoring/fleet_reader.hpp"

#include <utility>

#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "shared/wire/served_robot_codec.hpp"
#include "shared/wire/status_codec.hpp"

namespace fleetloc {
namespace {

constexpr std::size_t kMaxNews = 10'000;

}  // namespace

FleetReader::FleetReader(std::uint32_t domain, const std::optional<FleetKeys>& keys)
    : participant_(domain, "monitor", nullptr, {.keys = keys}),
      robots_(participant_.create_reader(served_robots_topic_spec())),
      localizers_(participant_.create_reader(served_localizers_topic_spec())),
      thread_({robots_.get(), localizers_.get()},
              [this](auto& reader) { return take_from(reader); }) {}

std::vector<FleetReader::News> FleetReader::take() {
  const std::lock_guard lock(mutex_);
  std::vector<News> taken(std::make_move_iterator(news_.begin()),
                          std::make_move_iterator(news_.end()));
  news_.clear();
  return taken;
}

std::uint64_t FleetReader::refused() const {
  const std::lock_guard lock(mutex_);
  return refused_;
}

bool FleetReader::take_from(eprosima::fastdds::dds::DataReader& reader) {
  Bytes payload;
  eprosima::fastdds::dds::SampleInfo info;
  if (reader.take_next_sample(&payload, &info) != ReturnCode_t::RETCODE_OK) return false;
  if (!info.valid_data) return true;
  const std::lock_guard lock(mutex_);
  const auto add = [this](auto decoded) {
    if (decoded) {
      news_.emplace_back(*std::move(decoded));
    } else {
      ++refused_;
    }
  };
  if (&reader == robots_.get()) {
    add(decode_served_robot(payload));
  } else {
    add(decode_localizer_status(payload));
  }
  if (news_.size() > kMaxNews) news_.pop_front();
  return true;
}

}  // namespace fleetloc
