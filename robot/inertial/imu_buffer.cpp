#include "robot/inertial/imu_buffer.hpp"

#include <algorithm>
#include <cassert>
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
  if (!is_possible(sample)) return false;
  if (!samples_.empty() && sample.stamp <= samples_.back().stamp) return false;
  samples_.push_back(sample);
  return true;
}

// The stamp that a sample of this time has now: later by what was left out after it.
Timestamp ImuBuffer::joined(Timestamp stamp) const {
  for (const Standstill& standstill : left_out_) {
    if (stamp >= standstill.to) continue;
    stamp = standstill.to - std::max(Duration{}, standstill.from - stamp);
  }
  return stamp;
}

std::vector<ImuSample> ImuBuffer::between(Timestamp from, Timestamp to) const {
  if (to < from || !covers(from) || !covers(to)) {
    return {};
  }
  from = joined(from);
  to = joined(to);
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

void ImuBuffer::leave_out(Timestamp from, Timestamp to) {
  assert(from <= to && covers(from) && covers(to));
  const Timestamp begin = joined(from);
  if (to <= begin) return;
  const auto first = std::ranges::lower_bound(samples_, begin, {}, &ImuSample::stamp);
  const auto last = std::ranges::lower_bound(samples_, to, {}, &ImuSample::stamp);
  for (auto before = samples_.begin(); before != first; ++before) before->stamp += to - begin;
  samples_.erase(first, last);
  if (!left_out_.empty() && left_out_.back().from == from) {
    left_out_.back().to = to;
  } else {
    left_out_.push_back({from, to});
  }
}

Duration ImuBuffer::left_out(Timestamp from, Timestamp to) const {
  Duration sum{};
  for (const Standstill& standstill : left_out_) {
    const auto begin = std::max(from, standstill.from);
    const auto end = std::min(to, standstill.to);
    sum += std::max(Duration{}, end - begin);
  }
  return sum;
}

void ImuBuffer::forget_before(Timestamp stamp) {
  forget_joined_before(joined(stamp));
}

void ImuBuffer::keep(Duration time) {
  if (!samples_.empty()) forget_joined_before(samples_.back().stamp - time);
}

void ImuBuffer::forget_joined_before(Timestamp stamp) {
  while (samples_.size() > 1 && samples_[1].stamp <= stamp) {
    samples_.pop_front();
  }
  std::erase_if(left_out_, [this](const Standstill& standstill) {
    return standstill.to < samples_.front().stamp;
  });
}

bool ImuBuffer::covers(Timestamp stamp) const {
  if (samples_.empty()) return false;
  const Timestamp at = joined(stamp);
  return samples_.front().stamp <= at && at <= samples_.back().stamp;
}

bool ImuBuffer::begins_after(Timestamp stamp) const {
  return !samples_.empty() && joined(stamp) < samples_.front().stamp;
}

}  // namespace fleetloc
