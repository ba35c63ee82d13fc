#include "shared/wire/correction_codec.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <idl/correction.h>

#include "shared/wire/cdr.hpp"
#include "shared/wire/columns.hpp"
#include "shared/wire/compact_root.hpp"
#include "shared/wire/fields.hpp"

namespace fleetloc {
namespace {

using PoseRoot = CompactRoot<6>;
using LandmarkRoot = CompactRoot<3>;

// As in correction.idl; Fast DDS does not enforce them.
constexpr std::size_t kMaxLandmarks = 128;
constexpr std::size_t kBytesPerLandmark = 14;  // without the wide entry that its gap may need
constexpr double kUnitsPerQuaternion = 1 << 30;
constexpr double kPoseUnitsPerMetre = 1e5;
constexpr double kLandmarkUnitsPerMetre = 500.0;
constexpr double kUnitNormTolerance = 1e-6;

template <std::size_t N>
void append(const std::array<std::uint8_t, N>& bytes, std::vector<std::uint8_t>& column) {
  column.insert(column.end(), bytes.begin(), bytes.end());
}

template <int N>
CompactRoot<N> root_at(const std::vector<std::uint8_t>& scales,
                       const std::vector<std::uint8_t>& entries,
                       std::size_t row) {
  CompactRoot<N> root;
  std::copy_n(scales.data() + row * root.scales.size(), root.scales.size(), root.scales.begin());
  std::copy_n(
      entries.data() + row * root.entries.size(), root.entries.size(), root.entries.begin());
  return root;
}

Eigen::Vector4d quaternion_at(const wire::Correction& sample, std::size_t row) {
  const std::int32_t* q = sample.pose_rotation().data() + 4 * row;
  return Eigen::Vector4d(q[0], q[1], q[2], q[3]) / kUnitsPerQuaternion;
}

Validity check_columns(const wire::Correction& sample) {
  const std::size_t poses = sample.pose_from().size();
  const std::size_t landmarks = sample.landmark_id().size();
  if (poses == 0 && landmarks == 0) return unexpected(Malformed::kTooFewItems);
  if (poses > kMaxCorrectedPoses || landmarks > kMaxLandmarks)
    return unexpected(Malformed::kTooManyItems);
  const bool equal = sample.pose_to().size() == poses &&
                     sample.pose_rotation().size() == 4 * poses &&
                     sample.pose_translation().size() == 3 * poses &&
                     sample.pose_scale().size() == PoseRoot::kScales * poses &&
                     sample.pose_information().size() == PoseRoot::kEntries * poses &&
                     sample.landmark_id_wide().size() == wide_entries(sample.landmark_id()) &&
                     sample.landmark_position().size() == 3 * landmarks &&
                     sample.landmark_scale().size() == LandmarkRoot::kScales * landmarks &&
                     sample.landmark_information().size() == LandmarkRoot::kEntries * landmarks;
  if (!equal) return unexpected(Malformed::kUnequalColumns);
  return {};
}

Validity check_poses(const wire::Correction& sample) {
  for (std::size_t i = 0; i < sample.pose_to().size(); ++i) {
    const std::uint32_t to = sample.pose_to()[i];
    if (sample.pose_from()[i] >= to || to > sample.anchor())
      return unexpected(Malformed::kUnorderedItems);
    if (i > 0 && to <= sample.pose_to()[i - 1]) return unexpected(Malformed::kUnorderedItems);
    if (std::abs(quaternion_at(sample, i).norm() - 1.0) > kUnitNormTolerance) {
      return unexpected(Malformed::kNotARotation);
    }
    const auto root = root_at<6>(sample.pose_scale(), sample.pose_information(), i);
    if (const Validity valid = root.check(); !valid) return valid;
  }
  return {};
}

Validity check_landmarks(const wire::Correction& sample) {
  constexpr auto kMax = static_cast<int>(kMaxCorrectedMetres * kLandmarkUnitsPerMetre);
  for (const int value : sample.landmark_position()) {
    if (std::abs(value) > kMax) return unexpected(Malformed::kOutOfRange);
  }
  GapReader<std::uint32_t> ids(sample.landmark_id(), sample.landmark_id_wide());
  for (std::size_t i = 0; i < sample.landmark_id().size(); ++i) {
    const auto id = ids.next();
    if (!id) return unexpected(Malformed::kUnorderedItems);
    if (*id > std::numeric_limits<std::uint32_t>::max()) return unexpected(Malformed::kOutOfRange);
    const auto root = root_at<3>(sample.landmark_scale(), sample.landmark_information(), i);
    if (const Validity valid = root.check(); !valid) return valid;
  }
  return {};
}

Validity check_sample(const wire::Correction& sample) {
  for (const auto check_part : {check_columns, check_poses, check_landmarks}) {
    if (const Validity valid = check_part(sample); !valid) return valid;
  }
  return {};
}

void append_poses(const Correction& correction, wire::Correction& sample) {
  for (const Correction::RelativePose& pose : correction.relative_poses) {
    sample.pose_from().push_back(static_cast<std::uint32_t>(pose.from));
    sample.pose_to().push_back(static_cast<std::uint32_t>(pose.to));
    const Eigen::Quaterniond& R = pose.T_from_to.R;
    for (const double value : {R.w(), R.x(), R.y(), R.z()}) {
      sample.pose_rotation().push_back(
          quantized<std::int32_t>(value, kUnitsPerQuaternion, "a rotation"));
    }
    for (const double value : pose.T_from_to.p) {
      sample.pose_translation().push_back(
          quantized<std::int32_t>(value, kPoseUnitsPerMetre, "a translation"));
    }
    const PoseRoot root = PoseRoot::of(pose.information);
    append(root.scales, sample.pose_scale());
    append(root.entries, sample.pose_information());
  }
}

void append_landmarks(const std::vector<Correction::Landmark>& landmarks,
                      wire::Correction& sample) {
  GapWriter<std::uint32_t> ids(sample.landmark_id(), sample.landmark_id_wide());
  for (const Correction::Landmark& landmark : landmarks) {
    ids.push(static_cast<std::uint32_t>(landmark.id));
    for (const double value : landmark.p_anchor) {
      sample.landmark_position().push_back(
          quantized<std::int16_t>(value, kLandmarkUnitsPerMetre, "a landmark's position"));
    }
    const LandmarkRoot root = LandmarkRoot::of(landmark.information);
    append(root.scales, sample.landmark_scale());
    append(root.entries, sample.landmark_information());
  }
}

Bytes encoded(const Correction& correction, const std::vector<Correction::Landmark>& landmarks) {
  wire::Correction sample;
  sample.robot(correction.robot);
  sample.localizer(correction.localizer);
  sample.session(static_cast<std::uint32_t>(correction.session));
  sample.incarnation(static_cast<std::uint32_t>(correction.incarnation));
  sample.anchor(static_cast<std::uint32_t>(correction.anchor));
  append_poses(correction, sample);
  append_landmarks(landmarks, sample);
  expect_encodable(check_sample(sample), "correction");  // as the receiver checks it
  return to_cdr(sample);
}

// In the order of their ids still.
void drop_least_informative(std::vector<Correction::Landmark>& landmarks, std::size_t count) {
  for (; count > 0 && !landmarks.empty(); --count) {
    landmarks.erase(std::ranges::min_element(
        landmarks, {}, [](const auto& landmark) { return landmark.information.trace(); }));
  }
}

}  // namespace

Bytes encode(const Correction& correction) {
  expect_encodable_id(correction.robot);
  expect_encodable_id(correction.localizer);
  Bytes bytes = encoded(correction, correction.landmarks);
  std::vector<Correction::Landmark> landmarks;
  while (bytes.size() > kMaxCorrectionBytes) {
    if (landmarks.empty()) landmarks = correction.landmarks;
    const std::size_t excess = bytes.size() - kMaxCorrectionBytes;
    drop_least_informative(landmarks, excess / (kBytesPerLandmark + sizeof(std::uint32_t)) + 1);
    bytes = encoded(correction, landmarks);
  }
  return bytes;
}

Decoded<Correction> decode_correction(std::span<const std::uint8_t> bytes) {
  const auto decoded = valid_from_cdr<wire::Correction>(bytes, 2, check_sample);
  if (!decoded) return unexpected(decoded.error());
  const auto& sample = *decoded;
  Correction correction;
  correction.robot = sample.robot().to_string();
  correction.session = SessionNumber{sample.session()};
  correction.localizer = sample.localizer().to_string();
  correction.incarnation = Incarnation{sample.incarnation()};
  correction.anchor = KeyframeId{sample.anchor()};
  for (std::size_t i = 0; i < sample.pose_to().size(); ++i) {
    const Eigen::Vector4d q = quaternion_at(sample, i);
    const std::int32_t* p = sample.pose_translation().data() + 3 * i;
    correction.relative_poses.push_back(
        {.from = KeyframeId{sample.pose_from()[i]},
         .to = KeyframeId{sample.pose_to()[i]},
         .T_from_to = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized(),
                       Eigen::Vector3d(p[0], p[1], p[2]) / kPoseUnitsPerMetre},
         .information = root_at<6>(sample.pose_scale(), sample.pose_information(), i).squared()});
  }
  GapReader<std::uint32_t> ids(sample.landmark_id(), sample.landmark_id_wide());
  for (std::size_t i = 0; i < sample.landmark_id().size(); ++i) {
    const std::int16_t* p = sample.landmark_position().data() + 3 * i;
    correction.landmarks.push_back(
        {.id = LandmarkId{static_cast<std::uint32_t>(ids.next().value())},
         .p_anchor = Eigen::Vector3d(p[0], p[1], p[2]) / kLandmarkUnitsPerMetre,
         .information =
             root_at<3>(sample.landmark_scale(), sample.landmark_information(), i).squared()});
  }
  return correction;
}

}  // namespace fleetloc
