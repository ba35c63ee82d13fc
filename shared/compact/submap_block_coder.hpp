#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "shared/compact/compact_submap.hpp"
#include "shared/compact/observation_coder.hpp"
#include "shared/compact/observation_predictor.hpp"
#include "shared/compact/submap_models.hpp"
#include "shared/model/camera.hpp"

namespace fleetloc {

/// Writes a submap or reads one, by one sequence of calls for both. Every function returns false if
/// what was read cannot be.
template <typename Coder>
class SubmapBlockCoder {
 public:
  /// @param models  as the first bit finds them
  SubmapBlockCoder(Coder& coder,
                   SubmapModels& models,
                   CompactSubmap& submap,
                   const RectifiedStereo& stereo)
      : coder_(coder), models_(models), submap_(submap), stereo_(stereo) {}

  bool code() {
    return code_head() && code_keyframes() && code_observations() && code_edges() &&
           coder_.code_raw(kEnd, 8) == kEnd;
  }

 private:
  using Keyframe = CompactSubmap::Keyframe;
  using Edge = CompactSubmap::Edge;

  static constexpr std::uint32_t kVersion = 2;
  static constexpr std::uint32_t kEnd = 0xA5;  // tells a garbled block
  static constexpr std::int32_t kMaxPosition = 1'000'000'000;
  static constexpr std::int32_t kMaxAge = 1'000'000'000;
  static constexpr std::int32_t kMaxDeviation = 100'000'000;

  static std::int32_t proportion(std::int64_t a, std::int64_t b, std::int64_t c);
  static bool is_within(std::int64_t value, std::int64_t max) {
    return value >= -max && value <= max;
  }
  bool code_head();
  bool code_keyframes();
  bool code_pose(std::size_t index);
  bool code_tilt(Keyframe& keyframe, std::int32_t& tilt);
  bool code_observations();
  bool code_edges();
  bool code_edge(Edge& edge, std::size_t kind, std::array<std::int32_t, 3>& sigma);

  Coder& coder_;
  SubmapModels& models_;
  CompactSubmap& submap_;
  const RectifiedStereo& stereo_;
};

// a * b / c to the nearest, halves upwards; c > 0.
template <typename Coder>
std::int32_t SubmapBlockCoder<Coder>::proportion(std::int64_t a, std::int64_t b, std::int64_t c) {
  const std::int64_t twice = 2 * a * b + c;
  const std::int64_t floor = twice >= 0 ? twice / (2 * c) : -((-twice + 2 * c - 1) / (2 * c));
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(floor, -kMaxPosition, kMaxPosition));
}

template <typename Coder>
bool SubmapBlockCoder<Coder>::code_head() {
  if (coder_.code_raw(kVersion, 4) != kVersion) return false;
  submap_.step_bits = coder_.code_raw(submap_.step_bits, 3);
  submap_.stride = 1 + coder_.code_raw(submap_.stride - 1, 1);
  submap_.offset = submap_.stride > 1 ? coder_.code_raw(submap_.offset, 1) : 0;
  const auto count = models_.keyframes.code(
      coder_, static_cast<std::uint32_t>(submap_.keyframes.size() - (Coder::kDecodes ? 0 : 1)));
  if (count >= CompactSubmap::kMaxKeyframes) return false;
  if (Coder::kDecodes) {
    const std::uint32_t newest = submap_.keyframes.back().id;
    submap_.keyframes.assign(count + 1, {});
    submap_.keyframes.back().id = newest;
  }
  return true;
}

// From the newest, whose pose is in the envelope, to the oldest.
template <typename Coder>
bool SubmapBlockCoder<Coder>::code_keyframes() {
  for (std::size_t i = submap_.keyframes.size() - 1; i-- > 0;) {
    if (!code_pose(i)) return false;
  }
  std::int32_t tilt = CompactSubmap::kUnknownTilt;
  for (std::size_t i = submap_.keyframes.size(); i-- > 0;) {
    if (!code_tilt(submap_.keyframes[i], tilt)) return false;
  }
  return true;
}

// The displacement to the next newer keyframe is predicted from that keyframe's own, at constant
// velocity.
template <typename Coder>
bool SubmapBlockCoder<Coder>::code_pose(std::size_t index) {
  Keyframe& keyframe = submap_.keyframes[index];
  const Keyframe& newer = submap_.keyframes[index + 1];
  const std::uint32_t gap = models_.id_gap.code(coder_, newer.id - keyframe.id - 1);
  if (gap >= newer.id) return false;
  keyframe.id = newer.id - gap - 1;

  const bool is_first = index + 2 == submap_.keyframes.size();
  const Keyframe& newest = submap_.keyframes.back();
  const Keyframe& second = is_first ? newest : submap_.keyframes[index + 2];
  const std::int32_t interval_before = newer.age - second.age;
  const std::int32_t interval =
      interval_before + (is_first ? models_.interval : models_.interval_change)
                            .code_signed(coder_, keyframe.age - newer.age - interval_before);
  if (interval <= 0 || interval > kMaxAge || newer.age > kMaxAge - interval) return false;
  keyframe.age = newer.age + interval;

  auto& models = is_first ? models_.displacement : models_.displacement_change;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t before = newer.position[axis] - second.position[axis];
    const std::int32_t expected =
        newer.position[axis] + (is_first ? 0 : proportion(before, interval, interval_before));
    const std::int64_t position =
        std::int64_t{expected} +
        models[axis / 2].code_signed(coder_, keyframe.position[axis] - expected);
    if (!is_within(position, kMaxPosition)) return false;
    keyframe.position[axis] = static_cast<std::int32_t>(position);
  }
  return code_turn(coder_, models_.turn, keyframe.turn, CompactSubmap::kUnitsPerQuaternion);
}

template <typename Coder>
bool SubmapBlockCoder<Coder>::code_tilt(Keyframe& keyframe, std::int32_t& tilt) {
  keyframe.has_observations = coder_.code(models_.has_observations, keyframe.has_observations);
  if (!keyframe.has_observations) return &keyframe != &submap_.keyframes.back();
  const bool is_first = tilt == CompactSubmap::kUnknownTilt;
  IntegerModel& model = is_first ? models_.tilt : models_.tilt_change;
  const std::int64_t coded = std::int64_t{tilt} + model.code_signed(coder_, keyframe.tilt - tilt);
  if (coded < 0 || coded > SigmaCode::kMax) return false;
  tilt = keyframe.tilt = static_cast<std::int32_t>(coded);
  return true;
}

template <typename Coder>
bool SubmapBlockCoder<Coder>::code_observations() {
  std::uint32_t first_landmark = UINT32_MAX;
  for (const Keyframe& keyframe : submap_.keyframes) {
    if (!keyframe.observations.empty())
      first_landmark = std::min(first_landmark, keyframe.observations.front().landmark);
  }
  first_landmark = coder_.code_raw(first_landmark, 32);
  const ObservationPredictor predictor(stereo_, submap_.step_bits, poses_of(submap_));
  ObservationCoder<Coder> observations(
      coder_, models_, predictor, {submap_.stride, submap_.offset}, first_landmark);
  for (std::size_t i = 0; i < submap_.keyframes.size(); ++i) {
    Keyframe& keyframe = submap_.keyframes[i];
    if (keyframe.has_observations && !observations.code(i, keyframe)) return false;
  }
  return true;
}

// An edge from each keyframe to the next, where there is one; then all others.
template <typename Coder>
bool SubmapBlockCoder<Coder>::code_edges() {
  std::vector<Edge> edges;
  std::vector<Edge> others;
  std::array<std::int32_t, 3> sigma{};
  auto actual = submap_.edges.begin();
  for (std::uint32_t to = 1; to < submap_.keyframes.size(); ++to) {
    Edge edge{.from = to - 1, .to = to};
    bool follows = false;
    for (; actual != submap_.edges.end() && actual->to == to; ++actual) {
      const bool is_next = actual->from + 1 == to;
      if (is_next) edge = *actual;
      if (!is_next) others.push_back(*actual);
      follows = follows || is_next;
    }
    if (!coder_.code(models_.follows, follows)) continue;
    if (!code_edge(edge, 0, sigma)) return false;
    edges.push_back(edge);
  }
  const auto count = models_.other_edges.code(coder_, static_cast<std::uint32_t>(others.size()));
  if (count > CompactSubmap::kMaxEdges) return false;
  others.resize(count);
  sigma = {};
  for (Edge& edge : others) {
    const auto newest = static_cast<std::uint32_t>(submap_.keyframes.size() - 1);
    const std::uint32_t back = models_.edge_to.code(coder_, newest - edge.to);
    if (back > newest) return false;
    edge.to = newest - back;
    const std::uint32_t span = models_.edge_from.code(coder_, edge.to - edge.from - 1);
    if (span >= edge.to) return false;
    edge.from = edge.to - span - 1;
    if (!code_edge(edge, 1, sigma)) return false;
    edges.push_back(edge);
  }
  if (Coder::kDecodes) {
    std::ranges::sort(edges, {}, [](const Edge& e) { return std::pair(e.to, e.from); });
    submap_.edges = std::move(edges);
  }
  return true;
}

template <typename Coder>
bool SubmapBlockCoder<Coder>::code_edge(Edge& edge,
                                        std::size_t kind,
                                        std::array<std::int32_t, 3>& sigma) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::int64_t coded = std::int64_t{sigma[i]} +
                               models_.sigma[kind][i].code_signed(coder_, edge.sigma[i] - sigma[i]);
    if (coded < 1 || coded > SigmaCode::kMax) return false;
    sigma[i] = edge.sigma[i] = static_cast<std::int32_t>(coded);
  }
  for (std::size_t i = 0; i < 6; ++i) {
    edge.deviation[i] = models_.deviation[kind][i / 3].code_signed(coder_, edge.deviation[i]);
    if (!is_within(edge.deviation[i], kMaxDeviation)) return false;
  }
  return true;
}

}  // namespace fleetloc
