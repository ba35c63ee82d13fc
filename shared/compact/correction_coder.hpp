#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shared/compact/compact_root.hpp"
#include "shared/compact/correction_block.hpp"
#include "shared/compact/correction_models.hpp"
#include "shared/compact/turn.hpp"

namespace fleetloc {

/// Corrections in the integers that are coded.
struct CodedPose {
  static constexpr std::int32_t kUnitsPerQuaternion = 1 << 16;
  static constexpr double kMetresPerUnit = 0.5e-3;
  static constexpr std::int32_t kMaxUnits = 40'000'000;

  std::uint32_t from = 0, to = 0;
  Turn turn;
  std::array<std::int32_t, 3> translation{};
  CompactRoot<6> root;
};

struct CodedLandmark {
  static constexpr double kMetresPerUnit = 2e-3;
  static constexpr auto kMaxUnits = static_cast<std::int32_t>(kMaxCorrectedMetres / kMetresPerUnit);

  std::uint32_t id = 0;
  std::array<std::int32_t, 3> position{};
  CompactRoot<3> root;
};

struct CodedCorrection {
  std::uint32_t anchor = 0;
  std::vector<CodedPose> poses{};          // increasing by `to`
  std::vector<CodedLandmark> landmarks{};  // increasing by id
};

/// Writes corrections or reads them; see SubmapBlockCoder.
template <typename Coder>
class CorrectionCoder {
 public:
  /// @param models  as the first bit finds them
  CorrectionCoder(Coder& coder, CorrectionModels& models, CodedCorrection& coded)
      : coder_(coder), models_(models), coded_(coded) {}

  bool code() {
    return coder_.code_raw(kVersion, 4) == kVersion && code_poses() && code_landmarks() &&
           coder_.code_raw(kEnd, 8) == kEnd;
  }

 private:
  static constexpr std::uint32_t kVersion = 2;
  static constexpr std::uint32_t kEnd = 0xA5;
  static constexpr int kLevel = 4;  // a level of the roots here, in entries of CompactRoot

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
  CorrectionModels& models_;
  CodedCorrection& coded_;
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
  if (!code_turn(coder_, models_.turn, pose.turn, CodedPose::kUnitsPerQuaternion)) return false;
  return std::ranges::all_of(pose.translation, [&](std::int32_t& value) {
    return code_within(models_.translation, value, CodedPose::kMaxUnits);
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
      if (!code_within(models_.position[axis], landmark.position[axis], CodedLandmark::kMaxUnits)) {
        return false;
      }
    }
    if (!code_root<3>(landmark.root, {&models_.landmark_root}, scale)) return false;
  }
  return true;
}

}  // namespace fleetloc
