#include "cloud/localizer/session_database.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <set>

namespace fleetloc {
namespace {

// Of a node of std::map beside its value.
constexpr std::size_t kNodeOverhead = 48;

KeyframeId beyond(KeyframeId id, int count) {
  const std::uint64_t sum = static_cast<std::uint64_t>(id) + static_cast<std::uint64_t>(count);
  return KeyframeId{static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, UINT32_MAX))};
}

// The newest keyframe of `submap` that observes `landmark`; if none does, the newest.
const SubmapKeyframe& reference_of(LandmarkId landmark, const Submap& submap) {
  const auto newest = std::find_if(
      submap.keyframes.rbegin(), submap.keyframes.rend(), [&](const SubmapKeyframe& keyframe) {
        return std::ranges::binary_search(
            keyframe.observations, landmark, {}, &StereoObservation::landmark);
      });
  return newest != submap.keyframes.rend() ? *newest : submap.keyframes.back();
}

}  // namespace

SessionDatabase::Added SessionDatabase::add(const Submap& submap) {
  Added added;
  for (const SubmapKeyframe& item : submap.keyframes) add_keyframe(item, added);
  for (const VirtualEdge& edge : submap.edges) add_edge(edge, added);
  if (!submap.keyframes.empty()) add_estimates(submap);
  forget_behind_window();
  return added;
}

void SessionDatabase::add_keyframe(const SubmapKeyframe& item, Added& added) {
  if (item.id < horizon_) {
    ++added.stale;
    return;
  }
  const auto [place, is_new] = keyframes_.try_emplace(item.id);
  if (!is_new && item.revision <= place->second.item.revision) {
    ++added.repeated;
    return;
  }
  unobserved_landmarks_ = unobserved_landmarks_ || !is_new;
  place->second.item = item;
  for (const StereoObservation& seen : item.observations) landmarks_.try_emplace(seen.landmark);
  ++added.stored;
}

void SessionDatabase::add_edge(const VirtualEdge& edge, Added& added) {
  // An edge may arrive before the keyframe it ends at, but not before one that is far ahead.
  const bool is_ahead =
      keyframes_.empty() || edge.to > beyond(keyframes_.rbegin()->first, config_.window);
  if (edge.from < horizon_ || edge.to <= edge.from || is_ahead) {
    ++added.stale;
    return;
  }
  const auto [place, is_new] = edges_.try_emplace(EdgeKey{edge.to, edge.from}, edge);
  if (!is_new) {
    if (edge.revision <= place->second.revision) {
      ++added.repeated;
      return;
    }
    place->second = edge;
  }
  ++added.stored;
}

// A landmark that is already solved keeps the cloud's position: the robot's is less exact.
void SessionDatabase::add_estimates(const Submap& submap) {
  for (const SubmapLandmark& landmark : submap.landmarks) {
    const auto place = landmarks_.find(landmark.id);
    if (place == landmarks_.end() || place->second.p_map) continue;
    const SubmapKeyframe& reference = reference_of(landmark.id, submap);
    if (!keyframes_.contains(reference.id)) continue;
    place->second.estimate = {reference.id, inverse(reference.T_odom_body) * landmark.p_odom};
  }
}

void SessionDatabase::forget_behind_window() {
  const auto window = static_cast<std::size_t>(config_.window);
  while (keyframes_.size() > window) {
    keyframes_.erase(keyframes_.begin());
    horizon_ = keyframes_.begin()->first;
    unobserved_landmarks_ = true;
  }
  if (!unobserved_landmarks_) return;
  unobserved_landmarks_ = false;
  std::erase_if(edges_, [this](const auto& entry) { return entry.second.from < horizon_; });

  std::vector<LandmarkId> seen;
  for (const auto& [id, keyframe] : keyframes_) {
    for (const StereoObservation& observation : keyframe.item.observations) {
      seen.push_back(observation.landmark);
    }
  }
  std::ranges::sort(seen);
  std::erase_if(landmarks_, [&seen](const auto& entry) {
    return !std::ranges::binary_search(seen, entry.first);
  });
  for (auto& [id, landmark] : landmarks_) {
    if (landmark.estimate && landmark.estimate->keyframe < horizon_) landmark.estimate.reset();
  }
}

const VirtualEdge* SessionDatabase::edge_into(KeyframeId to) const {
  for (auto edge = edges_.upper_bound(EdgeKey{to, to}); edge != edges_.begin();) {
    --edge;
    if (edge->second.to != to) break;
    if (keyframes_.contains(edge->second.from)) return &edge->second;
  }
  return nullptr;
}

// The edges of edge_into() form a forest; the window is the tree of the newest keyframe.
std::vector<KeyframeId> SessionDatabase::window() const {
  std::map<KeyframeId, KeyframeId> root;
  for (const auto& [id, keyframe] : keyframes_) {
    const VirtualEdge* edge = edge_into(id);
    root[id] = edge == nullptr ? id : root.at(edge->from);  // from < to
  }
  std::vector<KeyframeId> window;
  for (const auto& [id, root_of_id] : root) {
    if (root_of_id == root.rbegin()->second) window.push_back(id);
  }
  return window;
}

std::map<KeyframeId, Pose> SessionDatabase::placed(const std::vector<KeyframeId>& window,
                                                   const Pose& T_map_odom) const {
  std::map<KeyframeId, Pose> poses;
  std::set<KeyframeId> anchored;  // solved, or along edges from a solved one
  for (const KeyframeId id : window) {
    const Keyframe& keyframe = keyframes_.at(id);
    const VirtualEdge* edge = edge_into(id);
    if (keyframe.T_map_body) {
      poses[id] = *keyframe.T_map_body;
      anchored.insert(id);
    } else if (edge != nullptr && anchored.contains(edge->from)) {
      poses[id] = poses.at(edge->from) * edge->T_from_to;
      anchored.insert(id);
    } else {
      poses[id] = T_map_odom * keyframe.item.T_odom_body;
    }
  }
  return poses;
}

void SessionDatabase::store_solution(KeyframeId id, const Pose& T_map_body) {
  keyframes_.at(id).T_map_body = T_map_body;
}

void SessionDatabase::store_solution(LandmarkId id, const Eigen::Vector3d& p_map) {
  landmarks_.at(id).p_map = p_map;
}

std::size_t SessionDatabase::memory_bytes() const {
  std::size_t bytes = edges_.size() * (sizeof(EdgeKey) + sizeof(VirtualEdge) + kNodeOverhead) +
                      landmarks_.size() * (sizeof(Landmark) + kNodeOverhead);
  for (const auto& [id, keyframe] : keyframes_) {
    bytes += sizeof(Keyframe) + kNodeOverhead +
             keyframe.item.observations.capacity() * sizeof(StereoObservation);
  }
  return bytes;
}

}  // namespace fleetloc
