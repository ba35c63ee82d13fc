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

constexpr double kLargestTilt_rad = 3.15;  // pi: not measured
constexpr double kFarthestLandmark_m = 1e6;

template <typename Column>
bool increases(const Column& column) {
  return std::ranges::adjacent_find(column, std::greater_equal<>{}) == column.end();
}

Validity check_counts(const wire::Submap& sample) {
  if (sample.keyframe_id().empty()) return unexpected(Malformed::kTooFewItems);
  if (sample.keyframe_id().size() > kMaxKeyframes || sample.edge_from().size() > kMaxEdges ||
      sample.landmark_id().size() > kMaxLandmarks ||
      sample.observation_landmark().size() > kMaxObservations) {
    return unexpected(Malformed::kTooManyItems);
  }
  return {};
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

Validity check_rotations(std::span<const std::int32_t> column) {
  for (std::size_t i = 0; i + 4 <= column.size(); i += 4) {
    const Eigen::Vector4d q(column[i], column[i + 1], column[i + 2], column[i + 3]);
    if (std::abs(q.norm() / kUnitsPerQuaternion - 1.0) > kUnitNormTolerance) {
      return unexpected(Malformed::kNotARotation);
    }
  }
  return {};
}

Validity check_keyframes(const wire::Submap& sample) {
  if (!increases(sample.keyframe_id())) return unexpected(Malformed::kUnorderedItems);
  for (const std::int64_t ns : sample.keyframe_stamp_ns()) {
    if (const Validity valid = check_stamp(ns); !valid) return valid;
  }
  if (!increases(sample.keyframe_stamp_ns())) return unexpected(Malformed::kUnorderedStamps);
  for (const float sigma : sample.keyframe_tilt_sigma()) {
    const auto min_sigma = static_cast<double>(std::numeric_limits<float>::min());
    if (const Validity valid = check(static_cast<double>(sigma), min_sigma, kLargestTilt_rad);
        !valid) {
      return valid;
    }
  }
  for (const std::int32_t value : std::span(sample.keyframe_translation()).first<3>()) {
    if (value != 0) return unexpected(Malformed::kOutOfRange);
  }
  return check_rotations(sample.keyframe_rotation());
}

Validity check_edges(const wire::Submap& sample) {
  for (std::size_t i = 0; i < sample.edge_from().size(); ++i) {
    if (std::max(sample.edge_from()[i], sample.edge_to()[i]) >= sample.keyframe_id().size()) {
      return unexpected(Malformed::kUnknownKeyframe);
    }
    if (sample.edge_from()[i] >= sample.edge_to()[i]) return unexpected(Malformed::kUnorderedItems);
    const std::span roots(sample.edge_information());
    if (const Validity valid = check(roots.subspan(kRootSize * i).first<kRootSize>()); !valid)
      return valid;
  }
  if (!increases(sample.edge_to())) return unexpected(Malformed::kUnorderedItems);
  return check_rotations(sample.edge_rotation());
}

Validity check_landmarks(const wire::Submap& sample) {
  GapReader<std::uint32_t> ids(sample.landmark_id(), sample.landmark_id_wide());
  for (std::size_t i = 0; i < sample.landmark_id().size(); ++i) {
    const auto id = ids.next();
    if (!id) return unexpected(Malformed::kUnorderedItems);
    if (*id > std::numeric_limits<std::uint32_t>::max()) return unexpected(Malformed::kOutOfRange);
  }
  for (const float value : sample.landmark_position()) {
    const Validity valid =
        check(static_cast<double>(value), -kFarthestLandmark_m, kFarthestLandmark_m);
    if (!valid) return valid;
  }
  return {};
}

Validity check_observations(const wire::Submap& sample) {
  GapReader<std::uint16_t> landmarks(sample.observation_landmark(),
                                     sample.observation_landmark_wide());
  for (const std::uint16_t count : sample.keyframe_observations()) {
    landmarks.restart();
    for (int i = 0; i < count; ++i) {
      const auto landmark = landmarks.next();
      if (!landmark) return unexpected(Malformed::kUnorderedItems);
      if (*landmark >= static_cast<std::int64_t>(sample.landmark_id().size())) {
        return unexpected(Malformed::kUnknownLandmark);
      }
    }
  }
  return {};
}

}  // namespace

Validity check(const wire::Submap& sample) {
  if (const Validity valid = check_counts(sample); !valid) return valid;
  if (!has_equal_keyframe_columns(sample) || !has_equal_edge_columns(sample) ||
      !has_equal_landmark_columns(sample) || !has_equal_observation_columns(sample)) {
    return unexpected(Malformed::kUnequalColumns);
  }
  if (const Validity valid = check(sample.origin_odom()); !valid) return valid;
  for (const auto check_part :
       {check_keyframes, check_edges, check_landmarks, check_observations}) {
    if (const Validity valid = check_part(sample); !valid) return valid;
  }
  return {};
}

}  // namespace fleetloc
