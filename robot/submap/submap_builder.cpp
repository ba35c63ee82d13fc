#include "robot/submap/submap_builder.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>
#include <set>

#include "shared/geometry/angle.hpp"

namespace fleetloc {
namespace {

bool same(const Pose& a, const Pose& b) {
  return a.R.coeffs() == b.R.coeffs() && a.p == b.p;
}

bool same(const StereoObservation& a, const StereoObservation& b) {
  return a.landmark == b.landmark && a.left == b.left && a.disparity == b.disparity;
}

/// Equal but for the revision.
bool same(const SubmapKeyframe& a, const SubmapKeyframe& b) {
  return a.stamp == b.stamp && same(a.T_odom_body, b.T_odom_body) && a.tilt_sigma == b.tilt_sigma &&
         std::ranges::equal(a.observations, b.observations, [](const auto& x, const auto& y) {
           return same(x, y);
         });
}

bool same(const VirtualEdge& a, const VirtualEdge& b) {
  return same(a.T_from_to, b.T_from_to) && a.information == b.information;
}

Revision after(Revision revision) {
  return Revision{static_cast<std::uint32_t>(revision) + 1};
}

/// `item` with the revision that follows from what was sent before, which it replaces.
template <typename Item>
Item& revise(Item& sent, Item item) {
  const bool repeated = sent.revision != Revision{} && same(sent, item);
  item.revision = repeated ? sent.revision : after(sent.revision);
  sent = std::move(item);
  return sent;
}

std::vector<StereoObservation> selected_only(const std::vector<StereoObservation>& observations,
                                             const std::set<LandmarkId>& selected) {
  std::vector<StereoObservation> out;
  std::ranges::copy_if(observations, std::back_inserter(out), [&](const StereoObservation& one) {
    return selected.contains(one.landmark);
  });
  return out;
}

}  // namespace

SubmapBuilder::SubmapBuilder(const Config& config) : config_(config) {}

Submap SubmapBuilder::build(const SubmapInput& input) {
  assert(!input.keyframes.empty() && input.keyframes.size() == input.inertial.states.size());
  diagnostics_ = {};
  record_marginalized(input);
  forget_before(input.keyframes.front().id);
  update_edges(input);
  Submap submap;
  add_keyframes(input, submap);
  std::set<KeyframeId> present;
  for (const SubmapKeyframe& keyframe : submap.keyframes) present.insert(keyframe.id);
  for (const auto& [key, sent] : sent_edges_) {
    if (present.contains(key.first) && present.contains(key.second)) {
      submap.edges.push_back(sent.edge);
    }
  }
  return submap;
}

void SubmapBuilder::update_edges(const SubmapInput& input) {
  const auto odometry = virtual_odometry(input.inertial, config_.model);
  if (!odometry) {
    diagnostics_.refusal = odometry.error();
    return;
  }
  const ChainOfPoses& chain = *odometry;
  diagnostics_.kl_divergence = chain.kl_divergence;
  for (std::size_t i = 0; i < chain.edges.size(); ++i) {
    const auto newer = static_cast<int>(chain.edges.size() - 1 - i);
    update_edge({input.keyframes[i + 1].id, input.keyframes[i].id},
                chain.edges[i],
                newer >= config_.final_behind_edges);
  }
}

void SubmapBuilder::update_edge(const EdgeKey& key, const RelativePose& relative, bool final) {
  SentEdge& sent = sent_edges_[key];
  if (sent.final) return;
  revise(sent.edge,
         VirtualEdge{.from = key.second,
                     .to = key.first,
                     .revision = {},
                     .T_from_to = relative.T_from_to,
                     .information = relative.information / config_.edge_covariance_inflation});
  sent.final = final;
  sent.edge.is_final = final;
}

// A landmark was marginalized if a keyframe that left the window observes it and no keyframe of the
// window does. Had it been rejected, that keyframe would not observe it either.
void SubmapBuilder::record_marginalized(const SubmapInput& input) {
  std::set<LandmarkId> present;
  for (const SubmapInputKeyframe& keyframe : input.keyframes) {
    for (const StereoObservation& one : keyframe.observations) present.insert(one.landmark);
  }
  std::set<LandmarkId> still_observed;
  for (const auto& [id, keyframe] : sent_keyframes_) {
    const bool leaves = id < input.keyframes.front().id;
    for (const StereoObservation& one : keyframe.observations) {
      if (!leaves) still_observed.insert(one.landmark);
      if (leaves && !present.contains(one.landmark)) marginalized_.insert(one.landmark);
    }
  }
  std::erase_if(marginalized_, [&](LandmarkId id) {
    return !still_observed.contains(id) || present.contains(id);
  });
  std::erase_if(sent_landmarks_, [&](const auto& sent) {
    return !present.contains(sent.first) && !marginalized_.contains(sent.first);
  });
}

std::vector<StereoObservation> SubmapBuilder::with_marginalized(
    const SubmapInputKeyframe& keyframe) const {
  const auto sent = sent_keyframes_.find(keyframe.id);
  if (sent == sent_keyframes_.end()) return keyframe.observations;
  std::vector<StereoObservation> both;
  std::ranges::merge(keyframe.observations,
                     selected_only(sent->second.observations, marginalized_),
                     std::back_inserter(both),
                     {},
                     &StereoObservation::landmark,
                     &StereoObservation::landmark);
  return both;
}

void SubmapBuilder::add_keyframes(const SubmapInput& input, Submap& submap) {
  std::vector<std::vector<StereoObservation>> observations;
  observations.reserve(input.keyframes.size());
  for (const auto& keyframe : input.keyframes) observations.push_back(with_marginalized(keyframe));
  std::vector<const std::vector<StereoObservation>*> images;
  images.reserve(observations.size());
  for (const auto& image : observations) images.push_back(&image);
  std::set<LandmarkId> sent;
  for (const auto& [id, p_odom] : sent_landmarks_) sent.insert(id);
  const auto selected = select_landmarks(config_.landmarks, images, input.landmarks, sent);
  diagnostics_.reliable_landmarks = reliable_landmarks(config_.landmarks, input.landmarks);
  diagnostics_.selected_landmarks = static_cast<int>(selected.size());
  for (std::size_t i = 0; i < input.keyframes.size(); ++i) {
    const SubmapInputKeyframe& keyframe = input.keyframes[i];
    submap.keyframes.push_back(
        revise(sent_keyframes_[keyframe.id],
               SubmapKeyframe{.id = keyframe.id,
                              .revision = {},
                              .stamp = keyframe.stamp,
                              .T_odom_body = input.inertial.states[i].T_odom_body,
                              .tilt_sigma = tilt_sigma(keyframe),
                              .observations = selected_only(observations[i], selected)}));
  }
  for (const CandidateLandmark& landmark : input.landmarks) {
    if (selected.contains(landmark.id)) sent_landmarks_[landmark.id] = landmark.p_odom;
  }
  for (const auto& [id, p_odom] : sent_landmarks_) submap.landmarks.push_back({id, p_odom});
}

double SubmapBuilder::tilt_sigma(const SubmapInputKeyframe& keyframe) const {
  if (!config_.use_tilt || !std::isfinite(keyframe.tilt_sigma)) return kUnknownTiltRad;
  return std::clamp(keyframe.tilt_sigma, config_.tilt_floor_rad, kUnknownTiltRad);
}

void SubmapBuilder::forget_before(KeyframeId oldest) {
  std::erase_if(sent_keyframes_, [oldest](const auto& entry) { return entry.first < oldest; });
  std::erase_if(sent_edges_, [oldest](const auto& entry) { return entry.first.second < oldest; });
}

SubmapBuilder::Config read_submap_builder_config(ConfigReader section) {
  ConfigReader landmarks = section.section("landmarks");
  return {
      .model =
          section.get<bool>("paper_mode") ? InertialModel::kPaper : InertialModel::kInertialMean,
      .final_behind_edges = section.integer("final_behind_edges", 0, 64),
      .edge_covariance_inflation = section.positive("edge_covariance_inflation"),
      .use_tilt = section.get<bool>("use_tilt"),
      .tilt_floor_rad = section.positive("tilt_floor_deg") * kRadPerDeg,
      .landmarks = {.more_observations_than = landmarks.integer("more_observations_than", 0, 100),
                    .max_relative_depth_sigma = landmarks.positive("max_relative_depth_sigma"),
                    .max_per_keyframe = landmarks.integer("max_per_keyframe", 1, 1000),
                    .cell_px = landmarks.positive("cell_px")}};
}

}  // namespace fleetloc
