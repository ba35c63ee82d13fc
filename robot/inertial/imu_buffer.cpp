#include "robot/inertial/imu_buffer.hpp"

#include <algorithm>
#include <iterator>

namespace fleetloc {
namespace {

ImuSample interpolated(const ImuSample& before, const ImuSample& after, Timestamp stamp) {
  const double share = to_seconds(stamp - before.stamp) / to_seconds(after.stamp - before.stamp);
  return {stamp,
          before.angular_velocity + share * (after.angular_velocity - before.angular_velocity),
          before.specific_force + share * (after.specific_force - before.specific_force)};
}

bool is_older(const ImuSample& sample, Timestamp stamp) {
  return sample.stamp < stamp;
}

}  // namespace

bool ImuBuffer::add(const ImuSample& sample) {
  const bool finite = sample.angular_velocity.allFinite() && sample.specific_force.allFinite();
  if (!finite || (!samples_.empty() && sample.stamp <= samples_.back().stamp)) {
    return false;
  }
  samples_.push_back(sample);
  return true;
}

std::vector<ImuSample> ImuBuffer::between(Timestamp from, Timestamp to) const {
  if (to < from || !covers(from) || !covers(to)) {
    return {};
  }
  const auto first = std::lower_bound(samples_.begin(), samples_.end(), from, is_older);
  const auto last = std::lower_bound(first, samples_.end(), to, is_older);  // at or after `to`
  std::vector<ImuSample> result;
  result.reserve(static_cast<std::size_t>(last - first) + 2);
  if (first->stamp > from) {
    result.push_back(interpolated(*std::prev(first), *first, from));
  }
  result.insert(result.end(), first, last);
  if (last->stamp == to) {
    result.push_back(*last);
  } else if (to > from) {
    result.push_back(interpolated(*std::prev(last), *last, to));
  }
  return result;
}

void ImuBuffer::forget_before(Timestamp stamp) {
  while (samples_.size() > 1 && samples_[1].stamp <= stamp) {
    samples_.pop_front();
  }
}

bool ImuBuffer::covers(Timestamp stamp) const {
  return !samples_.empty() && samples_.front().stamp <= stamp && stamp <= samples_.back().stamp;
}

bool ImuBuffer::begins_after(Timestamp stamp) const {
  return !samples_.empty() && stamp < samples_.front().stamp;
}

}  // namespace fleetloc
