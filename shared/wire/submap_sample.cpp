#include "shared/wire/submap_sample.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <span>

#include <Eigen/Core>

#include "shared/wire/columns.hpp"
#include "shared/wire/fields.hpp"

namespace fleetloc {
namespace {

// As in submap.idl; Fast DDS does not enforce them.
constexpr std::size_t kMaxKeyframes = 64;
constexpr std::size_t kMaxEdges = 64;
constexpr std::size_t kMaxLandmarks = 8192;
constexpr std::size_t kMaxObservations = 16384;

constexpr double kUnitNormTolerance = 1e-6;
constexpr double kLargestTilt_rad = 3.15;  // pi: not measured
constexpr double kFarthestLandmark_m = 1e6;

template <typename Column>
bool increases(const Column& column) {
  return std::ranges::adjacent_find(column, std::greater_equal<>{}) == column.end();
}

Defect defect_of_counts(const wire::Submap& sample) {
  if (sample.keyframe_id().empty()) return Malformed::kTooFewItems;
  if (sample.keyframe_id().size() > kMaxKeyframes || sample.edge_from().size() > kMaxEdges ||
      sample.landmark_id().size() > kMaxLandmarks ||
      sample.observation_landmark().size() > kMaxObservations) {
    return Malformed::kTooManyItems;
  }
  return std::nullopt;
}

bool has_equal_keyframe_columns(const wire::Submap& sample) {
  const std::size_t count = sample.keyframe_id().size();
  return sample.keyframe_revision().size() == count && sample.keyframe_stamp_ns().size() == count &&
         sample.keyframe_rotation().size() == 4 * count &&
         sample.keyframe_translation().size() == 3 * count &&
         sample.keyframe_tilt_sigma().size() == count &&
         sample.keyframe_observations().size() == count;
}

bool has_equal_edge_columns(const wire::Submap& sample) {
  const std::size_t count = sample.edge_from().size();
  return sample.edge_to().size() == count && sample.edge_revision().size() == count &&
         sample.edge_rotation().size() == 4 * count &&
         sample.edge_translation().size() == 3 * count &&
         sample.edge_information().size() == kRootSize * count;
}

bool has_equal_landmark_columns(const wire::Submap& sample) {
  return sample.landmark_id_wide().size() == wide_entries(sample.landmark_id()) &&
         sample.landmark_position().size() == 3 * sample.landmark_id().size();
}

bool has_equal_observation_columns(const wire::Submap& sample) {
  const std::size_t count = sample.observation_landmark().size();
  const auto& per_keyframe = sample.keyframe_observations();
  return std::accumulate(per_keyframe.begin(), per_keyframe.end(), std::size_t{0}) == count &&
         sample.observation_landmark_wide().size() == wide_entries(sample.observation_landmark()) &&
         sample.observation_left_u().size() == count &&
         sample.observation_left_v().size() == count &&
         sample.observation_disparity().size() == count;
}

Defect defect_of_rotations(std::span<const std::int32_t> column) {
  for (std::size_t i = 0; i + 4 <= column.size(); i += 4) {
    const Eigen::Vector4d q(column[i], column[i + 1], column[i + 2], column[i + 3]);
    if (std::abs(q.norm() / kUnitsPerQuaternion - 1.0) > kUnitNormTolerance) {
      return Malformed::kNotARotation;
    }
  }
  return std::nullopt;
}

Defect defect_of_keyframes(const wire::Submap& sample) {
  if (!increases(sample.keyframe_id())) return Malformed::kUnorderedItems;
  for (const std::int64_t ns : sample.keyframe_stamp_ns()) {
    if (const Defect found = defect_of_stamp(ns)) return found;
  }
  if (!increases(sample.keyframe_stamp_ns())) return Malformed::kUnorderedStamps;
  for (const float sigma : sample.keyframe_tilt_sigma()) {
    const auto min_sigma = static_cast<double>(std::numeric_limits<float>::min());
    if (const Defect found = defect(static_cast<double>(sigma), min_sigma, kLargestTilt_rad)) {
      return found;
    }
  }
  for (const std::int32_t value : std::span(sample.keyframe_translation()).first<3>()) {
    if (value != 0) return Malformed::kOutOfRange;
  }
  return defect_of_rotations(sample.keyframe_rotation());
}

Defect defect_of_edges(const wire::Submap& sample) {
  for (std::size_t i = 0; i < sample.edge_from().size(); ++i) {
    if (std::max(sample.edge_from()[i], sample.edge_to()[i]) >= sample.keyframe_id().size()) {
      return Malformed::kUnknownKeyframe;
    }
    if (sample.edge_from()[i] >= sample.edge_to()[i]) return Malformed::kUnorderedItems;
    const std::span roots(sample.edge_information());
    if (const Defect found = defect(roots.subspan(kRootSize * i).first<kRootSize>())) return found;
  }
  if (!increases(sample.edge_to())) return Malformed::kUnorderedItems;
  return defect_of_rotations(sample.edge_rotation());
}

Defect defect_of_landmarks(const wire::Submap& sample) {
  GapReader<std::uint32_t> ids(sample.landmark_id(), sample.landmark_id_wide());
  for (std::size_t i = 0; i < sample.landmark_id().size(); ++i) {
    const auto id = ids.next();
    if (!id) return Malformed::kUnorderedItems;
    if (*id > std::numeric_limits<std::uint32_t>::max()) return Malformed::kOutOfRange;
  }
  for (const float value : sample.landmark_position()) {
    const Defect found =
        defect(static_cast<double>(value), -kFarthestLandmark_m, kFarthestLandmark_m);
    if (found) return found;
  }
  return std::nullopt;
}

Defect defect_of_observations(const wire::Submap& sample) {
  GapReader<std::uint16_t> landmarks(sample.observation_landmark(),
                                     sample.observation_landmark_wide());
  for (const std::uint16_t count : sample.keyframe_observations()) {
    landmarks.restart();
    for (int i = 0; i < count; ++i) {
      const auto landmark = landmarks.next();
      if (!landmark) return Malformed::kUnorderedItems;
      if (*landmark >= static_cast<std::int64_t>(sample.landmark_id().size())) {
        return Malformed::kUnknownLandmark;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

Defect defect(const wire::Submap& sample) {
  if (const Defect found = defect_of_counts(sample)) return found;
  if (!has_equal_keyframe_columns(sample) || !has_equal_edge_columns(sample) ||
      !has_equal_landmark_columns(sample) || !has_equal_observation_columns(sample)) {
    return Malformed::kUnequalColumns;
  }
  if (const Defect found = defect(sample.origin_odom())) return found;
  for (const auto check :
       {defect_of_keyframes, defect_of_edges, defect_of_landmarks, defect_of_observations}) {
    if (const Defect found = check(sample)) return found;
  }
  return std::nullopt;
}

}  // namespace fleetloc
