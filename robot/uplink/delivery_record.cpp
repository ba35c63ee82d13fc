#include "robot/uplink/delivery_record.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <vector>

namespace fleetloc {
namespace {

constexpr std::size_t kMaxSamples = 1024;        // older ones are not waited for
constexpr double kValueOfProvisionalEdge = 0.7;  // of what a final one is worth to the cloud

std::vector<LandmarkId> landmarks_of(const SubmapKeyframe& keyframe) {
  std::vector<LandmarkId> landmarks;
  landmarks.reserve(keyframe.observations.size());
  for (const StereoObservation& one : keyframe.observations) landmarks.push_back(one.landmark);
  return landmarks;
}

// Of all that are in one of them: what was rejected since is to be taken back as well.
double common_share(const std::vector<LandmarkId>& sent, const std::vector<LandmarkId>& wanted) {
  std::vector<LandmarkId> common;
  std::ranges::set_intersection(sent, wanted, std::back_inserter(common));
  const std::size_t all = sent.size() + wanted.size() - common.size();
  return all == 0 ? 1.0 : static_cast<double>(common.size()) / static_cast<double>(all);
}

}  // namespace

void DeliveryRecord::clear() {
  *this = {};
}

void DeliveryRecord::sent(SampleNumber number, const Submap& submap, ObservationSubset subset) {
  const auto n = static_cast<std::uint32_t>(number);
  samples_[n] = Fate::kUnknown;
  if (samples_.size() > kMaxSamples) samples_.erase(samples_.begin());
  for (const SubmapKeyframe& keyframe : submap.keyframes) {
    if (keyframe.is_reference) continue;
    keyframes_[keyframe.id].push_back({n, landmarks_of(keyframe), subset});
  }
  for (const VirtualEdge& edge : submap.edges) {
    edges_[{edge.to, edge.from}].push_back({n, edge.is_final});
  }
}

// What is below the base was seen in an earlier acknowledgement, or is not known to have arrived.
void DeliveryRecord::acknowledged(const Acknowledgements& acknowledgements) {
  if (acknowledgements.bitmap == 0) return;
  const auto base = static_cast<std::uint64_t>(acknowledgements.base);
  const auto newest =
      base + 63 - static_cast<std::uint64_t>(std::countl_zero(acknowledgements.bitmap));
  for (auto& [number, fate] : samples_) {
    if (number > newest) break;
    const bool is_covered = number >= base;
    if (is_covered && ((acknowledgements.bitmap >> (number - base)) & 1U) != 0) {
      fate = Fate::kArrived;
    } else if (fate == Fate::kUnknown) {
      fate = Fate::kLost;
    }
  }
}

double DeliveryRecord::arrival_probability(std::uint32_t number, double loss) const {
  const auto sample = samples_.find(number);
  if (sample == samples_.end() || sample->second == Fate::kLost) return 0.0;
  return sample->second == Fate::kArrived ? 1.0 : 1.0 - loss;
}

double DeliveryRecord::missing(const SubmapKeyframe& keyframe, double loss) const {
  const auto sendings = keyframes_.find(keyframe.id);
  if (sendings == keyframes_.end()) return 1.0;
  const std::vector<LandmarkId> wanted = landmarks_of(keyframe);
  std::array<double, 2> missing{1.0, 1.0};  // of either half of the landmarks
  for (const Sending& one : sendings->second) {
    const double share = common_share(one.landmarks, wanted);
    for (std::uint32_t half = 0; half < 2; ++half) {
      if (half % one.subset.stride != one.subset.offset) continue;
      missing[half] *= 1.0 - share * arrival_probability(one.number, loss);
    }
  }
  return (missing[0] + missing[1]) / 2.0;
}

double DeliveryRecord::missing(const VirtualEdge& edge, double loss) const {
  const auto sendings = edges_.find({edge.to, edge.from});
  if (sendings == edges_.end()) return 1.0;
  double missing = 1.0;
  for (const EdgeSending& one : sendings->second) {
    const double value = one.is_final || !edge.is_final ? 1.0 : kValueOfProvisionalEdge;
    missing *= 1.0 - value * arrival_probability(one.number, loss);
  }
  return missing;
}

void DeliveryRecord::forget_before(KeyframeId oldest) {
  std::erase_if(keyframes_, [oldest](const auto& item) { return item.first < oldest; });
  std::erase_if(edges_, [oldest](const auto& item) { return item.first.from < oldest; });
}

}  // namespace fleetloc
