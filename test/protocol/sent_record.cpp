#include "test/protocol/sent_record.hpp"

#include <algorithm>
#include <utility>

#include "shared/compact/submap_sample.hpp"

namespace fleetloc {
namespace {

constexpr std::uint32_t kRememberedKeyframes = 150;
constexpr std::size_t kRememberedStreams = 120;  // of all robots

bool is_same(const Pose& a, const Pose& b) {
  return a.R.coeffs() == b.R.coeffs() && a.p == b.p;
}

bool is_same(const StereoObservation& a, const StereoObservation& b) {
  return a.landmark == b.landmark && a.left == b.left && a.disparity == b.disparity;
}

const StereoObservation* find(const SubmapKeyframe& keyframe, LandmarkId landmark) {
  const auto& all = keyframe.observations;
  const auto place = std::ranges::lower_bound(all, landmark, {}, &StereoObservation::landmark);
  return place != all.end() && place->landmark == landmark ? &*place : nullptr;
}

const SubmapKeyframe* find(const Submap& submap, KeyframeId id) {
  const auto place = std::ranges::find(submap.keyframes, id, &SubmapKeyframe::id);
  return place != submap.keyframes.end() ? &*place : nullptr;
}

std::uint32_t number_of(Revision revision) {
  return static_cast<std::uint32_t>(revision) - 1;  // see revision_of()
}

std::string text(KeyframeId id) {
  return std::to_string(static_cast<std::uint32_t>(id));
}

}  // namespace

const Submap& SentRecord::add(const Bytes& payload, const RectifiedStereo& stereo) {
  Submap submap = decode_submap(decode_submap_sample(payload).value(), stereo).value();
  const StreamKey key{{submap.robot, submap.session}, submap.incarnation};
  if (!streams_.contains(key) && streams_.size() >= kRememberedStreams) {
    streams_.erase(std::ranges::min_element(
        streams_, {}, [](const auto& item) { return item.second.last_used; }));
  }
  Stream& stream = streams_[key];
  stream.last_used = ++samples_;
  const auto number = static_cast<std::uint32_t>(submap.number);
  for (const SubmapKeyframe& keyframe : submap.keyframes) {
    stream.numbers[keyframe.id].push_back(number);
  }
  prune(stream);
  return stream.samples[number] = std::move(submap);
}

void SentRecord::prune(Stream& stream) {
  const auto newest = static_cast<std::uint32_t>(stream.numbers.rbegin()->first);
  const KeyframeId oldest{newest - std::min(newest, kRememberedKeyframes)};
  std::erase_if(stream.numbers, [&](const auto& item) { return item.first < oldest; });
  std::erase_if(stream.samples,
                [&](const auto& item) { return item.second.keyframes.back().id < oldest; });
}

std::string SentRecord::check_origin(const SessionDatabase& database,
                                     const SessionKey& session,
                                     Incarnation incarnation) const {
  const auto known = streams_.find(StreamKey{session, incarnation});
  if (known == streams_.end()) return "a database of a session that sent nothing";
  const Stream& stream = known->second;
  for (const auto& [id, keyframe] : database.keyframes()) {
    if (auto violation = check_keyframe(keyframe.item, stream); !violation.empty()) {
      return "keyframe " + text(id) + " " + violation;
    }
  }
  for (const VirtualEdge* edge : database.spanning_edges()) {
    const auto sample = stream.samples.find(number_of(edge->revision));
    const bool is_known = sample != stream.samples.end() &&
                          std::ranges::any_of(sample->second.edges, [&](const VirtualEdge& sent) {
                            return sent.from == edge->from && sent.to == edge->to &&
                                   is_same(sent.T_from_to, edge->T_from_to) &&
                                   sent.information == edge->information;
                          });
    if (!is_known) return "an edge into " + text(edge->to) + " was never sent";
  }
  return {};
}

std::string SentRecord::check_keyframe(const SubmapKeyframe& stored, const Stream& stream) const {
  const auto newest = stream.samples.find(number_of(stored.revision));
  if (newest == stream.samples.end()) return "is of a sample that was never sent";
  const SubmapKeyframe* sent = find(newest->second, stored.id);
  if (sent == nullptr) return "was not in that sample";
  if (sent->stamp != stored.stamp || sent->tilt_sigma != stored.tilt_sigma ||
      !is_same(sent->T_odom_body, stored.T_odom_body)) {
    return "differs from what was sent";
  }
  for (const StereoObservation& one : sent->observations) {
    if (find(stored, one.landmark) == nullptr) return "lacks an observation of its own sample";
  }
  if (std::ranges::adjacent_find(stored.observations,
                                 std::ranges::greater_equal(),
                                 &StereoObservation::landmark) != stored.observations.end()) {
    return "has an observation twice";
  }
  const auto& numbers = stream.numbers.at(stored.id);
  for (const StereoObservation& one : stored.observations) {
    const bool is_known = std::ranges::any_of(numbers, [&](std::uint32_t number) {
      const StereoObservation* candidate =
          find(*find(stream.samples.at(number), stored.id), one.landmark);
      return candidate != nullptr && is_same(*candidate, one);
    });
    if (!is_known) return "has an observation that was never sent";
  }
  return {};
}

std::string SentRecord::check_stored(const SessionDatabase& database, const Submap& sample) const {
  const auto& keyframes = database.keyframes();
  const KeyframeId horizon = keyframes.begin()->first;
  const Stream& stream =
      streams_.at({SessionKey{sample.robot, sample.session}, sample.incarnation});
  for (const SubmapKeyframe& sent : sample.keyframes) {
    if (sent.id < horizon) continue;
    const auto stored = keyframes.find(sent.id);
    if (stored == keyframes.end()) return "keyframe " + text(sent.id) + " is not there";
    for (const StereoObservation& one : sent.observations) {
      const StereoObservation* found = find(stored->second.item, one.landmark);
      if (found != nullptr && is_same(*found, one)) continue;
      const auto& numbers = stream.numbers.at(sent.id);
      const bool is_replaced = std::ranges::any_of(numbers, [&](std::uint32_t number) {
        return number > static_cast<std::uint32_t>(sample.number) &&
               find(stream.samples.at(number), sent.id)->subset.has(one.landmark, sent.id);
      });
      if (!is_replaced) return "keyframe " + text(sent.id) + " lacks an observation";
    }
  }
  return {};
}

}  // namespace fleetloc
