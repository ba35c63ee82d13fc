#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

#include "shared/compact/compact_submap.hpp"
#include "shared/compact/observation_predictor.hpp"
#include "shared/compact/submap_models.hpp"
#include "shared/model/submap.hpp"

namespace fleetloc {

/// Codes the observations of one keyframe after the other, oldest first. A landmark that has been
/// seen in the sample is predicted from its last observation; of others id and pixels are coded.
template <typename Coder>
class ObservationCoder {
 public:
  using Observation = CompactSubmap::Observation;

  /// @param first_landmark  no observation is of an earlier one
  ObservationCoder(Coder& coder,
                   SubmapModels& models,
                   const ObservationPredictor& predictor,
                   ObservationSubset subset,
                   std::uint32_t first_landmark)
      : coder_(coder),
        models_(models),
        predictor_(predictor),
        subset_(subset),
        first_landmark_(first_landmark) {}

  /// @param keyframe  index; its observations are read by an encoder and set by a decoder
  /// @return false if what was decoded is out of range
  [[nodiscard]] bool code(std::size_t index, CompactSubmap::Keyframe& keyframe);

 private:
  using Tracks = std::map<std::uint32_t, LandmarkTrack>;

  [[nodiscard]] bool is_due(std::uint64_t landmark, const CompactSubmap::Keyframe& keyframe) const {
    return subset_.has(LandmarkId{static_cast<std::uint32_t>(landmark)}, KeyframeId{keyframe.id});
  }
  /// The value, if it is a pixel; else what is coded is not valid.
  std::int32_t checked(std::int64_t value, std::int32_t min);
  static const Observation* find(const std::vector<Observation>& observations, std::uint32_t id);
  Observation code_seen(LandmarkTrack& track, std::size_t index, const Observation& actual);
  bool code_new(std::size_t index,
                const CompactSubmap::Keyframe& keyframe,
                const std::vector<Observation>& actual,
                std::vector<Observation>& coded);
  Observation code_first(const Observation& actual);
  std::int32_t code_disparity(std::int32_t actual);

  Coder& coder_;
  SubmapModels& models_;
  const ObservationPredictor& predictor_;
  ObservationSubset subset_;
  std::uint32_t first_landmark_;
  Tracks tracks_;
  bool is_valid_ = true;
};

template <typename Coder>
std::int32_t ObservationCoder<Coder>::checked(std::int64_t value, std::int32_t min) {
  is_valid_ = is_valid_ && value >= min && value <= predictor_.max_steps();
  return is_valid_ ? static_cast<std::int32_t>(value) : min;
}

template <typename Coder>
const CompactSubmap::Observation* ObservationCoder<Coder>::find(
    const std::vector<Observation>& observations, std::uint32_t id) {
  const auto place = std::ranges::lower_bound(observations, id, {}, &Observation::landmark);
  return place != observations.end() && place->landmark == id ? &*place : nullptr;
}

template <typename Coder>
bool ObservationCoder<Coder>::code(std::size_t index, CompactSubmap::Keyframe& keyframe) {
  std::vector<Observation> coded;
  std::vector<Observation> fresh;  // of landmarks that have no track
  if (!Coder::kDecodes) {
    std::ranges::copy_if(keyframe.observations, std::back_inserter(fresh), [&](const auto& one) {
      return !tracks_.contains(one.landmark);
    });
  }
  for (auto node = tracks_.begin(); node != tracks_.end();) {
    auto& [landmark, track] = *node;
    if (!is_due(landmark, keyframe)) {
      ++node;
      continue;
    }
    const Observation* actual = find(keyframe.observations, landmark);
    BitModel& model = models_.observed[track.seen_class()][track.misses];
    if (coder_.code(model, actual != nullptr)) {
      coded.push_back(code_seen(track, index, actual != nullptr ? *actual : Observation{landmark}));
    } else if (++track.misses == SubmapModels::kMisses) {
      node = tracks_.erase(node);
      continue;
    }
    ++node;
  }
  if (!code_new(index, keyframe, fresh, coded) || !is_valid_) return false;
  if (Coder::kDecodes) {
    std::ranges::sort(coded, {}, &Observation::landmark);
    keyframe.observations = std::move(coded);
  }
  const auto& all = keyframe.observations;
  return all.size() <= CompactSubmap::kMaxObservations &&
         std::ranges::adjacent_find(all, {}, &Observation::landmark) == all.end();
}

template <typename Coder>
CompactSubmap::Observation ObservationCoder<Coder>::code_seen(LandmarkTrack& track,
                                                              std::size_t index,
                                                              const Observation& actual) {
  const PredictedObservation expected = predictor_.predict(track, index);
  const std::size_t seen = track.seen_class();
  Observation coded = actual;
  const auto deviation = [&](IntegerModel& model, int actual_steps, int expected_steps) {
    return std::int64_t{expected_steps} + model.code_signed(coder_, actual_steps - expected_steps);
  };
  coded.u = checked(deviation(models_.u[seen], actual.u, expected.u), 0);
  coded.v = checked(deviation(models_.v[seen], actual.v, expected.v), 0);
  coded.disparity = 0;
  if (coder_.code(models_.in_right[track.last.disparity > 0 ? 1 : 0], actual.disparity > 0)) {
    if (expected.disparity > 0.0) {
      const int near = rounded(expected.disparity, 1, predictor_.max_steps());
      coded.disparity = checked(deviation(models_.disparity[seen], actual.disparity, near), 1);
    } else {
      coded.disparity = code_disparity(actual.disparity);
    }
  }
  track.add(coded, index, expected.disparity);
  return coded;
}

// Ids that increase, then the pixels of each.
template <typename Coder>
bool ObservationCoder<Coder>::code_new(std::size_t index,
                                       const CompactSubmap::Keyframe& keyframe,
                                       const std::vector<Observation>& actual,
                                       std::vector<Observation>& coded) {
  const std::uint32_t count =
      models_.new_landmarks.code(coder_, static_cast<std::uint32_t>(actual.size()));
  if (count > CompactSubmap::kMaxObservations) return false;
  std::uint64_t next = first_landmark_;  // the first that may come
  while (!is_due(next, keyframe)) ++next;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Observation& one = Coder::kDecodes ? Observation{} : actual[i];
    IntegerModel& model = i == 0 ? models_.first_landmark : models_.landmark_gap;
    const auto gap =
        Coder::kDecodes ? 0U : static_cast<std::uint32_t>((one.landmark - next) / subset_.stride);
    const std::uint64_t id = next + std::uint64_t{model.code(coder_, gap)} * subset_.stride;
    if (id > UINT32_MAX) return false;
    Observation first = code_first(one);
    first.landmark = static_cast<std::uint32_t>(id);
    LandmarkTrack& track = tracks_[first.landmark];
    track = {};
    track.add(first, index, 0.0);
    coded.push_back(first);
    next = id + subset_.stride;
  }
  return true;
}

template <typename Coder>
CompactSubmap::Observation ObservationCoder<Coder>::code_first(const Observation& actual) {
  Observation coded;
  const auto code_pixel = [&](IntegerModel& model, std::int32_t value, std::int32_t center) {
    return checked(std::int64_t{center} + model.code_signed(coder_, value - center), 0);
  };
  coded.u = code_pixel(models_.new_u, actual.u, predictor_.center_u());
  coded.v = code_pixel(models_.new_v, actual.v, predictor_.center_v());
  if (coder_.code(models_.in_right[1], actual.disparity > 0)) {
    coded.disparity = code_disparity(actual.disparity);
  }
  return coded;
}

// Nothing is expected of it.
template <typename Coder>
std::int32_t ObservationCoder<Coder>::code_disparity(std::int32_t actual) {
  const auto above = static_cast<std::uint32_t>(Coder::kDecodes ? 0 : actual - 1);
  return checked(std::int64_t{models_.new_disparity.code(coder_, above)} + 1, 1);
}

}  // namespace fleetloc
