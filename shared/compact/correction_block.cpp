#include "shared/compact/correction_block.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "shared/coding/integer_model.hpp"
#include "shared/coding/range_decoder.hpp"
#include "shared/coding/range_encoder.hpp"
#include "shared/compact/compact_root.hpp"
#include "shared/compact/turn.hpp"
#include "shared/wire/malformed.hpp"

namespace fleetloc {
namespace {

constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kEnd = 0xA5;
constexpr std::int32_t kUnitsPerQuaternion = 1 << 16;
constexpr double kPoseUnit = 0.5e-3;    // [m]
constexpr double kLandmarkUnit = 2e-3;  // [m]
constexpr std::int32_t kMaxPoseUnits = 40'000'000;
constexpr auto kMaxLandmarkUnits = static_cast<std::int32_t>(kMaxCorrectedMetres / kLandmarkUnit);
constexpr int kLevel = 4;  // a level of the roots here, in entries of CompactRoot

/// Models of roots of one size.
struct RootModels {
  IntegerModel scale;  // change from the one before
  IntegerModel diagonal, other;
};

struct CorrectionModels {
  IntegerModel poses;
  IntegerModel newest_gap, gap, span;
  TurnModels turn;
  IntegerModel translation;
  std::array<RootModels, 2> pose_root;  // by scale: rotation, translation
  IntegerModel landmarks;
  IntegerModel first_landmark, landmark_gap;
  std::array<IntegerModel, 3> position;
  RootModels landmark_root;
};

struct CodedPose {
  std::uint32_t from = 0, to = 0;
  Turn turn;
  std::array<std::int32_t, 3> translation{};
  CompactRoot<6> root;
};

struct CodedLandmark {
  std::uint32_t id = 0;
  std::array<std::int32_t, 3> position{};
  CompactRoot<3> root;
};

struct CodedCorrection {
  std::uint32_t anchor = 0;
  std::vector<CodedPose> poses{};          // increasing by `to`
  std::vector<CodedLandmark> landmarks{};  // increasing by id
};

/// Writes corrections or reads them; see BlockCoder in submap_block.cpp.
template <typename Coder>
class CorrectionCoder {
 public:
  CorrectionCoder(Coder& coder, CodedCorrection& coded) : coder_(coder), coded_(coded) {}

  bool code() {
    return coder_.code_raw(kVersion, 4) == kVersion && code_poses() && code_landmarks() &&
           coder_.code_raw(kEnd, 8) == kEnd;
  }

 private:
  bool code_poses();
  bool code_pose(CodedPose& pose);
  bool code_landmarks();
  bool code_within(IntegerModel& model, std::int32_t& value, std::int32_t max) {
    value = model.code_signed(coder_, value);
    return value >= -max && value <= max;
  }
  template <int N>
  bool code_root(CompactRoot<N>& root,
                 std::array<RootModels*, CompactRoot<N>::kScales> models,
                 std::array<int, CompactRoot<N>::kScales>& scale);

  Coder& coder_;
  CodedCorrection& coded_;
  CorrectionModels models_;
};

template <typename Coder>
template <int N>
bool CorrectionCoder<Coder>::code_root(CompactRoot<N>& root,
                                       std::array<RootModels*, CompactRoot<N>::kScales> models,
                                       std::array<int, CompactRoot<N>::kScales>& scale) {
  for (std::size_t group = 0; group < root.scales.size(); ++group) {
    const int change = models[group]->scale.code_signed(coder_, root.scales[group] - scale[group]);
    if (change < -255 || change > 255) return false;
    scale[group] += change;
    if (scale[group] < 0 || scale[group] > CompactRoot<N>::kMaxScale) return false;
    root.scales[group] = static_cast<std::uint8_t>(scale[group]);
  }
  std::size_t next = 0;
  for (std::size_t row = 0; row < N; ++row) {
    for (std::size_t column = row; column < N; ++column, ++next) {
      RootModels& model = *models[column / 3];
      std::int32_t level = (root.entries[next] - CompactRoot<N>::kZero) / kLevel;
      if (!code_within(row == column ? model.diagonal : model.other, level, 31)) return false;
      root.entries[next] = static_cast<std::uint8_t>(level * kLevel + CompactRoot<N>::kZero);
    }
  }
  return root.check().has_value();
}

template <typename Coder>
bool CorrectionCoder<Coder>::code_poses() {
  const auto count = models_.poses.code(coder_, static_cast<std::uint32_t>(coded_.poses.size()));
  if (count > kMaxCorrectedPoses) return false;
  coded_.poses.resize(count);
  std::array<int, 2> scale{};
  std::uint32_t bound = coded_.anchor;  // newest first
  for (std::size_t i = count; i-- > 0;) {
    CodedPose& pose = coded_.poses[i];
    const std::uint32_t gap =
        (i + 1 == count ? models_.newest_gap : models_.gap).code(coder_, bound - pose.to);
    if (gap > bound) return false;
    pose.to = bound - gap;
    const std::uint32_t span = models_.span.code(coder_, pose.to - pose.from - 1);
    if (span >= pose.to) return false;
    pose.from = pose.to - span - 1;
    if (i > 0 && pose.to == 0) return false;
    bound = pose.to - 1;
    if (!code_pose(pose) ||
        !code_root<6>(pose.root, {&models_.pose_root[0], &models_.pose_root[1]}, scale)) {
      return false;
    }
  }
  return true;
}

template <typename Coder>
bool CorrectionCoder<Coder>::code_pose(CodedPose& pose) {
  if (!code_turn(coder_, models_.turn, pose.turn, kUnitsPerQuaternion)) return false;
  return std::ranges::all_of(pose.translation, [&](std::int32_t& value) {
    return code_within(models_.translation, value, kMaxPoseUnits);
  });
}

template <typename Coder>
bool CorrectionCoder<Coder>::code_landmarks() {
  const auto count =
      models_.landmarks.code(coder_, static_cast<std::uint32_t>(coded_.landmarks.size()));
  if (count > kMaxCorrectedLandmarks) return false;
  coded_.landmarks.resize(count);
  std::array<int, 1> scale{};
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    CodedLandmark& landmark = coded_.landmarks[i];
    const auto gap = static_cast<std::uint32_t>(landmark.id - next);
    const std::uint64_t id =
        next + (i == 0 ? coder_.code_raw(gap, 32) : models_.landmark_gap.code(coder_, gap));
    if (id > UINT32_MAX) return false;
    landmark.id = static_cast<std::uint32_t>(id);
    next = id + 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!code_within(models_.position[axis], landmark.position[axis], kMaxLandmarkUnits)) {
        return false;
      }
    }
    if (!code_root<3>(landmark.root, {&models_.landmark_root}, scale)) return false;
  }
  return true;
}

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
    coded.poses.push_back({.from = static_cast<std::uint32_t>(pose.from),
                           .to = static_cast<std::uint32_t>(pose.to),
                           .turn = turn_of({q.w(), q.x(), q.y(), q.z()}, kUnitsPerQuaternion),
                           .translation = units_of(pose.T_from_to.p, kPoseUnit, kMaxPoseUnits),
                           .root = CompactRoot<6>::of(pose.information)});
  }
  for (const Correction::Landmark& landmark : correction.landmarks) {
    coded.landmarks.push_back(
        {.id = static_cast<std::uint32_t>(landmark.id),
         .position = units_of(landmark.p_anchor, kLandmarkUnit, kMaxLandmarkUnits),
         .root = CompactRoot<3>::of(landmark.information)});
  }
  RangeEncoder encoder;
  if (!CorrectionCoder<RangeEncoder>(encoder, coded).code()) {
    throw NotEncodable("a correction out of range");
  }
  return encoder.finish();
}

std::optional<Correction> decode_corrections(std::span<const std::uint8_t> bytes,
                                             KeyframeId anchor) {
  CodedCorrection coded{.anchor = static_cast<std::uint32_t>(anchor)};
  RangeDecoder decoder(bytes);
  if (!CorrectionCoder<RangeDecoder>(decoder, coded).code() || decoder.is_overrun()) {
    return std::nullopt;
  }
  Correction correction;
  correction.anchor = anchor;
  for (const CodedPose& pose : coded.poses) {
    const StrictRotation q = normalized(rotation_of(pose.turn, kUnitsPerQuaternion));
    correction.relative_poses.push_back({.from = KeyframeId{pose.from},
                                         .to = KeyframeId{pose.to},
                                         .T_from_to = {Eigen::Quaterniond(q[0], q[1], q[2], q[3]),
                                                       metres_of(pose.translation, kPoseUnit)},
                                         .information = pose.root.squared()});
  }
  for (const CodedLandmark& landmark : coded.landmarks) {
    correction.landmarks.push_back({.id = LandmarkId{landmark.id},
                                    .p_anchor = metres_of(landmark.position, kLandmarkUnit),
                                    .information = landmark.root.squared()});
  }
  return correction;
}

}  // namespace fleetloc
