#include "test/protocol/stream_model.hpp"

#include <algorithm>

namespace fleetloc {

void StreamModel::lose_track() {
  for (const auto& [id, numbers] : numbers_) unsure_.insert(id);
}

void StreamModel::sent(const Submap& sample) {
  const auto number = static_cast<std::uint32_t>(sample.number);
  lost_[number] = false;
  for (const SubmapKeyframe& keyframe : sample.keyframes) numbers_[keyframe.id].push_back(number);
}

void StreamModel::acknowledged(const Acknowledgements& acknowledgements) {
  const auto base = static_cast<std::uint64_t>(acknowledgements.base);
  std::uint64_t newest = 0;
  for (std::uint64_t bit = 0; bit < 64; ++bit) {
    if (((acknowledgements.bitmap >> bit) & 1U) == 0) continue;
    if (lost_.empty() || base + bit > lost_.rbegin()->first) return;  // was never sent
    newest = base + bit;
    const auto sample = lost_.find(static_cast<std::uint32_t>(newest));
    if (sample != lost_.end()) arrived_.insert(sample->first);
  }
  for (auto& [number, is_lost] : lost_) {
    if (number < newest) is_lost = !arrived_.contains(number);
  }
}

bool StreamModel::may_be_missing(KeyframeId keyframe) const {
  return unsure_.contains(keyframe) || is_missing(keyframe);
}

bool StreamModel::is_missing(KeyframeId keyframe) const {
  if (unsure_.contains(keyframe)) return false;
  const auto sent = numbers_.find(keyframe);
  return sent == numbers_.end() ||
         std::ranges::all_of(sent->second, [&](std::uint32_t number) { return lost_.at(number); });
}

void StreamModel::forget_before(KeyframeId oldest) {
  std::erase_if(numbers_, [&](const auto& item) { return item.first < oldest; });
  unsure_.erase(unsure_.begin(), unsure_.lower_bound(oldest));
  if (numbers_.empty()) return;
  std::uint32_t first = UINT32_MAX;
  for (const auto& [id, numbers] : numbers_) first = std::min(first, numbers.front());
  lost_.erase(lost_.begin(), lost_.lower_bound(first));
  arrived_.erase(arrived_.begin(), arrived_.lower_bound(first));
}

}  // namespace fleetloc
