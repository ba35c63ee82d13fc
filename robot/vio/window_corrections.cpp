#include "robot/vio/window_corrections.hpp"

#include <algorithm>
#include <cassert>
#include <memory>
#include <utility>

#include "robot/vio/correction_factors.hpp"
#include "robot/vio/window_graph.hpp"

namespace fleetloc {
namespace {

GraphKeyframe* keyframe_of(WindowGraph& graph, KeyframeId id) {
  const auto found = std::ranges::find(graph.keyframes, id, &GraphKeyframe::id);
  return found != graph.keyframes.end() ? &*found : nullptr;
}

// A keyframe that arrived late parts a pair that spanned it: both would tell the same twice.
bool share_way(const WindowCorrections::Pair& a, const Correction::RelativePose& b) {
  return a.first < b.to && b.from < a.second;
}

bool is_active(const WindowGraph& graph, LandmarkId id) {
  const auto found = graph.landmarks.find(id);
  return found != graph.landmarks.end() && found->second.is_active();
}

const PoseParameters* first_pose_of(const GraphKeyframe& keyframe) {
  return keyframe.first_pose ? &*keyframe.first_pose : nullptr;
}

[[maybe_unused]] bool finite(const Correction::Landmark& landmark) {
  return landmark.p_anchor.allFinite() && landmark.information.allFinite();
}

[[maybe_unused]] bool finite(const Correction::RelativePose& relative) {
  return relative.T_from_to.R.coeffs().allFinite() && relative.T_from_to.p.allFinite() &&
         relative.information.allFinite();
}

}  // namespace

int size_of(const Correction& correction) {
  return static_cast<int>(correction.landmarks.size() + correction.relative_poses.size());
}

MergeCount merge(const Correction& correction, WindowGraph& graph) {
  WindowCorrections& known = graph.corrections;
  MergeCount count;
  if (correction.anchor < known.newest_anchor) {
    count.ignored = size_of(correction);
    return count;
  }
  known.newest_anchor = correction.anchor;
  if (keyframe_of(graph, correction.anchor) != nullptr) {
    for (const Correction::Landmark& landmark : correction.landmarks) {
      assert(finite(landmark));
      if (is_active(graph, landmark.id)) {
        known.landmarks[landmark.id] = {correction.anchor, landmark};
        ++count.applied;
      }
    }
  }
  auto older = std::exchange(known.relative_poses, {});
  std::map<WindowCorrections::Pair, Correction::RelativePose> newest;
  for (const Correction::RelativePose& relative : correction.relative_poses) {
    assert(finite(relative));
    if (keyframe_of(graph, relative.from) != nullptr &&
        keyframe_of(graph, relative.to) != nullptr) {
      std::erase_if(older, [&](const auto& item) { return share_way(item.first, relative); });
      newest[{relative.from, relative.to}] = relative;
      ++count.applied;
    }
  }
  newest.merge(older);
  known.relative_poses = std::move(newest);
  count.ignored = size_of(correction) - count.applied;
  return count;
}

void forget_corrections(WindowGraph& graph) {
  graph.corrections.landmarks.clear();
  graph.corrections.relative_poses.clear();
}

void drop_stale_corrections(WindowGraph& graph) {
  std::erase_if(graph.corrections.landmarks, [&graph](const auto& item) {
    return keyframe_of(graph, item.second.anchor) == nullptr || !is_active(graph, item.first);
  });
  std::erase_if(graph.corrections.relative_poses, [&graph](const auto& item) {
    return keyframe_of(graph, item.first.first) == nullptr ||
           keyframe_of(graph, item.first.second) == nullptr;
  });
}

std::vector<GraphFactor> correction_factors(WindowGraph& graph) {
  std::vector<GraphFactor> factors;
  for (const auto& [id, landmark] : graph.corrections.landmarks) {
    GraphKeyframe& anchor = *keyframe_of(graph, landmark.anchor);
    factors.push_back(
        {std::make_unique<LandmarkCorrectionFactor>(landmark.correction, first_pose_of(anchor)),
         {anchor.pose.data(), graph.landmarks.at(id).p_odom.data()}});
  }
  for (const auto& [pair, relative] : graph.corrections.relative_poses) {
    GraphKeyframe& from = *keyframe_of(graph, pair.first);
    GraphKeyframe& to = *keyframe_of(graph, pair.second);
    factors.push_back(
        {std::make_unique<PoseCorrectionFactor>(relative, first_pose_of(from), first_pose_of(to)),
         {from.pose.data(), to.pose.data()}});
  }
  return factors;
}

}  // namespace fleetloc
