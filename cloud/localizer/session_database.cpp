#include "cloud/localizer/session_database.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <ranges>

#include <Eigen/LU>

#include "shared/geometry/covariance.hpp"

namespace fleetloc {
namespace {

// Of a node of std::map beside its value.
constexpr std::size_t kNodeOverhead = 48;

constexpr std::size_t kRigidLandmarks = 3;  // that determine a rigid motion

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

std::uint32_t half_of(LandmarkId landmark, KeyframeId keyframe) {
  return ObservationSubset{2, 1}.has(landmark, keyframe) ? 1 : 0;
}

/// Keyframes that edges connect, as a forest of parents (Tarjan, 1975).
class Components {
 public:
  void join(KeyframeId a, KeyframeId b) {
    const KeyframeId root = root_of(a);
    parents_[root_of(b)] = root;
  }
  bool are_joined(KeyframeId a, KeyframeId b) { return root_of(a) == root_of(b); }

 private:
  KeyframeId root_of(KeyframeId id) {
    KeyframeId& parent = parents_.try_emplace(id, id).first->second;
    if (parent != id) parent = root_of(parent);
    return parent;
  }

  std::map<KeyframeId, KeyframeId> parents_;
};

// How many are in both; each is sorted, and may hold one several times.
std::size_t common(std::vector<LandmarkId> a, std::vector<LandmarkId> b) {
  std::vector<LandmarkId> both;
  a.erase(std::ranges::unique(a).begin(), a.end());
  b.erase(std::ranges::unique(b).begin(), b.end());
  std::ranges::set_intersection(a, b, std::back_inserter(both));
  return both.size();
}

// Adds the poses of keyframes that edges connect with one that has a pose.
void place_along(const std::vector<const VirtualEdge*>& edges, std::map<KeyframeId, Pose>& poses) {
  for (bool has_grown = true; has_grown;) {
    has_grown = false;
    for (const VirtualEdge* edge : edges) {
      const auto from = poses.find(edge->from);
      const auto to = poses.find(edge->to);
      if ((from == poses.end()) == (to == poses.end())) continue;
      if (to == poses.end()) {
        poses[edge->to] = from->second * edge->T_from_to;
      } else {
        poses[edge->from] = to->second * inverse(edge->T_from_to);
      }
      has_grown = true;
    }
  }
}

}  // namespace

SessionDatabase::Added SessionDatabase::add(const Submap& submap) {
  Added added;
  for (const SubmapKeyframe& item : submap.keyframes) add_keyframe(item, added);
  for (const VirtualEdge& edge : submap.edges) add_edge(edge, added);
  if (!submap.keyframes.empty()) add_estimates(submap);
  forget_behind_window();
  join();
  return added;
}

void SessionDatabase::forget_solutions() {
  for (auto& [id, keyframe] : keyframes_) keyframe.T_map_body.reset();
  for (auto& [id, landmark] : landmarks_) landmark.p_map.reset();
}

void SessionDatabase::forget_before(KeyframeId first) {
  horizon_ = first;
  keyframes_.erase(keyframes_.begin(), keyframes_.lower_bound(first));
  forget_unobserved();
  join();
}

void SessionDatabase::add_keyframe(const SubmapKeyframe& item, Added& added) {
  if (item.id < horizon_) {
    ++added.stale;
    return;
  }
  const auto [place, is_new] = keyframes_.try_emplace(item.id);
  Keyframe& known = place->second;
  std::array<bool, 2> is_newer{};  // of either half of the observations
  for (std::uint32_t half = 0; half < 2; ++half) {
    const bool is_told = half % item.subset.stride == item.subset.offset;
    is_newer[half] = is_told && (is_new || item.revision > known.halves[half]);
    if (is_newer[half]) known.halves[half] = item.revision;
  }
  const bool replaces = is_new || item.revision > known.item.revision;
  if (!replaces && !is_newer[0] && !is_newer[1]) {
    ++added.repeated;
    return;
  }
  unobserved_landmarks_ = unobserved_landmarks_ || !is_new;
  std::vector<StereoObservation> merged;
  const auto is_kept = [&](const StereoObservation& one) {
    return !is_newer[half_of(one.landmark, item.id)];
  };
  std::ranges::copy_if(known.item.observations, std::back_inserter(merged), is_kept);
  std::ranges::copy_if(item.observations, std::back_inserter(merged), std::not_fn(is_kept));
  std::ranges::sort(merged, {}, &StereoObservation::landmark);
  if (replaces) known.item = item;
  known.item.observations = std::move(merged);
  for (const StereoObservation& seen : known.item.observations) {
    landmarks_.try_emplace(seen.landmark);
  }
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
  if (unobserved_landmarks_) forget_unobserved();
}

void SessionDatabase::forget_unobserved() {
  unobserved_landmarks_ = false;
  std::erase_if(edges_, [this](const auto& entry) { return entry.second.from < horizon_; });

  std::vector<KeyframeId> kept;
  std::ranges::copy(std::views::keys(keyframes_), std::back_inserter(kept));
  const std::vector<LandmarkId> seen = seen_by(kept);
  std::erase_if(landmarks_, [&seen](const auto& entry) {
    return !std::ranges::binary_search(seen, entry.first);
  });
  for (auto& [id, landmark] : landmarks_) {
    if (landmark.estimate && landmark.estimate->keyframe < horizon_) landmark.estimate.reset();
  }
}

bool SessionDatabase::is_loose(const VirtualEdge& edge) const {
  const Duration gap = keyframes_.at(edge.to).item.stamp - keyframes_.at(edge.from).item.stamp;
  if (to_seconds(gap) <= config_.blind_s) return false;
  const Matrix6d covariance = edge.information.inverse();
  return !(max_sigma(covariance.bottomRightCorner<3, 3>()) <= config_.loose_edge_m);
}

// Loose edges last: what else holds together is on the same side of one.
void SessionDatabase::join() {
  std::vector<const VirtualEdge*> edges;
  for (const auto& [key, edge] : edges_) {
    if (keyframes_.contains(edge.from) && keyframes_.contains(edge.to)) edges.push_back(&edge);
  }
  std::ranges::stable_sort(edges, {}, [](const VirtualEdge* edge) {
    return static_cast<std::uint32_t>(edge->to) - static_cast<std::uint32_t>(edge->from);
  });
  const auto loose = std::ranges::stable_partition(
      edges, [this](const VirtualEdge* edge) { return !is_loose(*edge); });
  Components components;
  const auto is_seen_from_both_sides = [&](const VirtualEdge& edge) {
    std::vector<KeyframeId> before;
    std::vector<KeyframeId> after;
    for (const KeyframeId id : std::views::keys(keyframes_)) {
      if (id <= edge.from || components.are_joined(id, edge.from)) before.push_back(id);
      if (id >= edge.to || components.are_joined(id, edge.to)) after.push_back(id);
    }
    return common(seen_by(before), seen_by(after)) >= kRigidLandmarks;
  };
  spanning_.clear();
  for (auto edge = edges.begin(); edge != edges.end(); ++edge) {
    const auto [from, to] = std::pair{(*edge)->from, (*edge)->to};
    if (components.are_joined(from, to)) continue;
    if (edge >= loose.begin() && !is_seen_from_both_sides(**edge)) continue;
    components.join(from, to);
    spanning_.push_back({to, from});
  }
}

std::vector<const VirtualEdge*> SessionDatabase::spanning_edges() const {
  std::vector<const VirtualEdge*> edges;
  edges.reserve(spanning_.size());
  for (const EdgeKey& key : spanning_) edges.push_back(&edges_.at(key));
  return edges;
}

std::vector<KeyframeId> SessionDatabase::window() const {
  Components components;
  for (const VirtualEdge* edge : spanning_edges()) components.join(edge->from, edge->to);
  const KeyframeId newest = keyframes_.rbegin()->first;
  std::vector<KeyframeId> window;
  for (const auto& [id, keyframe] : keyframes_) {
    if (components.are_joined(id, newest)) window.push_back(id);
  }
  return window;
}

std::vector<LandmarkId> SessionDatabase::seen_by(std::span<const KeyframeId> keyframes) const {
  std::vector<LandmarkId> seen;
  for (const KeyframeId id : keyframes) {
    for (const StereoObservation& observation : keyframes_.at(id).item.observations) {
      seen.push_back(observation.landmark);
    }
  }
  std::ranges::sort(seen);
  return seen;
}

std::map<KeyframeId, Pose> SessionDatabase::placed(const std::vector<KeyframeId>& window,
                                                   const Pose& T_map_odom) const {
  std::map<KeyframeId, Pose> poses;
  for (const KeyframeId id : window) {
    if (const auto& solved = keyframes_.at(id).T_map_body) poses[id] = *solved;
  }
  if (!poses.empty()) place_along(spanning_edges(), poses);
  for (const KeyframeId id : window) {
    poses.try_emplace(id, T_map_odom * keyframes_.at(id).item.T_odom_body);
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
  std::size_t bytes = edges_.size() * (2 * sizeof(EdgeKey) + sizeof(VirtualEdge) + kNodeOverhead) +
                      landmarks_.size() * (sizeof(Landmark) + kNodeOverhead);
  for (const auto& [id, keyframe] : keyframes_) {
    bytes += sizeof(Keyframe) + kNodeOverhead +
             keyframe.item.observations.capacity() * sizeof(StereoObservation);
  }
  return bytes;
}

}  // namespace fleetloc
