#include "shared/compact/correction_block.hpp"

#include <algorithm>
#include <array>

#include "shared/coding/range_decoder.hpp"
#include "shared/coding/range_encoder.hpp"
#include "shared/compact/correction_coder.hpp"
#include "shared/compact/trained_models.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {
namespace {

std::array<std::int32_t, 3> units_of(const Eigen::Vector3d& p, double unit, std::int32_t max) {
  if (!((p / unit).cwiseAbs().maxCoeff() < max)) throw NotEncodable("a position in a correction");
  return {rounded(p.x() / unit, -max, max),
          rounded(p.y() / unit, -max, max),
          rounded(p.z() / unit, -max, max)};
}

Eigen::Vector3d metres_of(const std::array<std::int32_t, 3>& units, double unit) {
  return {units[0] * unit, units[1] * unit, units[2] * unit};
}

void expect_ordered(const Correction& correction) {
  const auto& poses = correction.relative_poses;
  const auto& landmarks = correction.landmarks;
  if (poses.size() > kMaxCorrectedPoses || landmarks.size() > kMaxCorrectedLandmarks) {
    throw NotEncodable("the number of corrections");
  }
  const bool forwards = std::ranges::all_of(
      poses, [&](const auto& pose) { return pose.from < pose.to && pose.to <= correction.anchor; });
  using Landmark = Correction::Landmark;
  using RelativePose = Correction::RelativePose;
  const auto increases = std::ranges::greater_equal{};
  if (!forwards || std::ranges::adjacent_find(poses, increases, &RelativePose::to) != poses.end() ||
      std::ranges::adjacent_find(landmarks, increases, &Landmark::id) != landmarks.end()) {
    throw NotEncodable("corrections out of order");
  }
}

}  // namespace

std::vector<std::uint8_t> encode_corrections(const Correction& correction) {
  expect_ordered(correction);
  CodedCorrection coded{.anchor = static_cast<std::uint32_t>(correction.anchor)};
  for (const Correction::RelativePose& pose : correction.relative_poses) {
    const Eigen::Quaterniond q = pose.T_from_to.R.normalized();
    coded.poses.push_back(
        {.from = static_cast<std::uint32_t>(pose.from),
         .to = static_cast<std::uint32_t>(pose.to),
         .turn = turn_of({q.w(), q.x(), q.y(), q.z()}, CodedPose::kUnitsPerQuaternion),
         .translation = units_of(pose.T_from_to.p, CodedPose::kMetresPerUnit, CodedPose::kMaxUnits),
         .root = CompactRoot<6>::of(pose.information)});
  }
  for (const Correction::Landmark& landmark : correction.landmarks) {
    coded.landmarks.push_back(
        {.id = static_cast<std::uint32_t>(landmark.id),
         .position =
             units_of(landmark.p_anchor, CodedLandmark::kMetresPerUnit, CodedLandmark::kMaxUnits),
         .root = CompactRoot<3>::of(landmark.information)});
  }
  RangeEncoder encoder;
  CorrectionModels models = trained_models().correction;
  if (!CorrectionCoder(encoder, models, coded).code()) {
    throw NotEncodable("a correction out of range");
  }
  return encoder.finish();
}

std::optional<Correction> decode_corrections(std::span<const std::uint8_t> bytes,
                                             KeyframeId anchor) {
  CodedCorrection coded{.anchor = static_cast<std::uint32_t>(anchor)};
  RangeDecoder decoder(bytes);
  CorrectionModels models = trained_models().correction;
  if (!CorrectionCoder(decoder, models, coded).code() || decoder.is_overrun()) {
    return std::nullopt;
  }
  Correction correction;
  correction.anchor = anchor;
  for (const CodedPose& pose : coded.poses) {
    const StrictRotation q = normalized(rotation_of(pose.turn, CodedPose::kUnitsPerQuaternion));
    correction.relative_poses.push_back(
        {.from = KeyframeId{pose.from},
         .to = KeyframeId{pose.to},
         .T_from_to = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]),
                       metres_of(pose.translation, CodedPose::kMetresPerUnit)},
         .information = pose.root.squared()});
  }
  for (const CodedLandmark& landmark : coded.landmarks) {
    correction.landmarks.push_back(
        {.id = LandmarkId{landmark.id},
         .p_anchor = metres_of(landmark.position, CodedLandmark::kMetresPerUnit),
         .information = landmark.root.squared()});
  }
  return correction;
}

}  // namespace fleetloc
