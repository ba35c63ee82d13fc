#include "robot/uplink/keyframe_history.hpp"

#include <algorithm>
#include <set>

#include <Eigen/LU>

namespace fleetloc {

void KeyframeHistory::add(const Submap& window) {
  for (const SubmapKeyframe& keyframe : window.keyframes) {
    const auto place = std::ranges::lower_bound(keyframes_, keyframe.id, {}, &SubmapKeyframe::id);
    if (place != keyframes_.end() && place->id == keyframe.id) {
      *place = keyframe;
    } else {
      keyframes_.insert(place, keyframe);
    }
  }
  for (const VirtualEdge& edge : window.edges) edges_[edge.to] = edge;
  if (keyframes_.size() > max_keyframes_) {
    keyframes_.erase(keyframes_.begin(),
                     keyframes_.end() - static_cast<std::ptrdiff_t>(max_keyframes_));
    std::erase_if(edges_,
                  [&](const auto& edge) { return edge.second.from < keyframes_.front().id; });
  }
}

void KeyframeHistory::clear() {
  keyframes_.clear();
  edges_.clear();
}

const SubmapKeyframe* KeyframeHistory::find(KeyframeId id) const {
  const auto place = std::ranges::lower_bound(keyframes_, id, {}, &SubmapKeyframe::id);
  return place != keyframes_.end() && place->id == id ? &*place : nullptr;
}

std::size_t KeyframeHistory::newer_than(KeyframeId id) const {
  const auto place = std::ranges::upper_bound(keyframes_, id, {}, &SubmapKeyframe::id);
  return static_cast<std::size_t>(keyframes_.end() - place);
}

const VirtualEdge* KeyframeHistory::edge_into(KeyframeId to) const {
  const auto edge = edges_.find(to);
  return edge != edges_.end() ? &edge->second : nullptr;
}

// Covariances are of right perturbations: that of the first part moves along the second.
std::optional<VirtualEdge> KeyframeHistory::composed(const EdgeKey& key) const {
  const VirtualEdge* last = edge_into(key.to);
  if (last == nullptr) return std::nullopt;
  VirtualEdge whole = *last;
  Matrix6d covariance = last->information.inverse();
  while (whole.from > key.from) {
    const VirtualEdge* step = edge_into(whole.from);
    if (step == nullptr) return std::nullopt;
    const Matrix6d move = adjoint(inverse(whole.T_from_to));
    covariance += move * step->information.inverse() * move.transpose();
    whole.T_from_to = step->T_from_to * whole.T_from_to;
    whole.from = step->from;
  }
  if (whole.from != key.from || find(key.from) == nullptr) return std::nullopt;
  whole.information = covariance.inverse();
  return whole;
}

Submap KeyframeHistory::submap(std::span<const KeyframeId> keyframes,
                               std::span<const EdgeKey> edges) const {
  Submap out;
  std::set<KeyframeId> needed(keyframes.begin(), keyframes.end());
  for (const EdgeKey& key : edges) {
    auto edge = composed(key);
    if (!edge) continue;
    needed.insert(key.from);
    needed.insert(key.to);
    out.edges.push_back(*std::move(edge));
  }
  for (const KeyframeId id : needed) {
    const SubmapKeyframe* known = find(id);
    if (known == nullptr) continue;
    out.keyframes.push_back(*known);
    out.keyframes.back().is_reference = std::ranges::find(keyframes, id) == keyframes.end();
  }
  return out;
}

}  // namespace fleetloc
