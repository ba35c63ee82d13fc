#include "robot/submap/landmark_selection.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace fleetloc {
namespace {

using Images = std::span<const std::vector<StereoObservation>* const>;

bool is_reliable(const LandmarkSelection& selection, const CandidateLandmark& landmark) {
  return landmark.observations > selection.more_observations_than &&
         landmark.relative_depth_sigma <= selection.max_relative_depth_sigma &&
         landmark.p_odom.allFinite();
}

/// Better ones compare less.
auto rank(const CandidateLandmark& landmark) {
  return std::tuple(-landmark.observations, landmark.relative_depth_sigma, landmark.id);
}

struct Candidate {
  const CandidateLandmark* landmark;
  std::vector<std::size_t> seen_in;  // indices of images
};
using Candidates = std::map<LandmarkId, Candidate>;

Candidates candidates_in(const LandmarkSelection& selection,
                         Images images,
                         std::span<const CandidateLandmark> landmarks) {
  Candidates candidates;
  for (const CandidateLandmark& landmark : landmarks) {
    if (is_reliable(selection, landmark)) {
      candidates.emplace_hint(candidates.end(), landmark.id, Candidate{&landmark, {}});
    }
  }
  for (std::size_t image = 0; image < images.size(); ++image) {
    for (const StereoObservation& observation : *images[image]) {
      const auto candidate = candidates.find(observation.landmark);
      if (candidate != candidates.end()) candidate->second.seen_in.push_back(image);
    }
  }
  return candidates;
}

/// The candidates of one image, the best of each cell first, then the second best of each cell...
std::vector<const Candidate*> spread(const LandmarkSelection& selection,
                                     const std::vector<StereoObservation>& image,
                                     const Candidates& candidates) {
  std::map<std::pair<int, int>, std::vector<const Candidate*>> cells;
  for (const StereoObservation& observation : image) {
    const auto candidate = candidates.find(observation.landmark);
    if (candidate == candidates.end()) continue;
    const std::pair cell(static_cast<int>(std::floor(observation.left.x() / selection.cell_px)),
                         static_cast<int>(std::floor(observation.left.y() / selection.cell_px)));
    cells[cell].push_back(&candidate->second);
  }
  std::vector<std::pair<std::size_t, const Candidate*>> places;
  for (auto& [cell, members] : cells) {
    std::ranges::sort(members, {}, [](const Candidate* c) { return rank(*c->landmark); });
    for (std::size_t place = 0; place < members.size(); ++place) {
      places.emplace_back(place, members[place]);
    }
  }
  std::ranges::sort(places, {}, [](const auto& entry) {
    return std::pair(entry.first, rank(*entry.second->landmark));
  });
  std::vector<const Candidate*> ordered;
  ordered.reserve(places.size());
  for (const auto& [place, candidate] : places) ordered.push_back(candidate);
  return ordered;
}

/// How many landmarks each image may still get.
class Capacity {
 public:
  Capacity(Images images, int max_observations, const std::set<LandmarkId>& already_sent) {
    for (const std::vector<StereoObservation>* image : images) {
      left_.push_back(max_observations - static_cast<int>(std::ranges::count_if(
                                             *image, [&already_sent](const StereoObservation& one) {
                                               return already_sent.contains(one.landmark);
                                             })));
    }
  }

  [[nodiscard]] bool has_room(std::size_t image) const { return left_[image] > 0; }
  [[nodiscard]] bool has_room_in_all(const std::vector<std::size_t>& images) const {
    return std::ranges::all_of(images, [this](std::size_t image) { return has_room(image); });
  }
  void use(const std::vector<std::size_t>& images) {
    for (const std::size_t image : images) --left_[image];
  }

 private:
  std::vector<int> left_;
};

}  // namespace

std::set<LandmarkId> select_landmarks(const LandmarkSelection& selection,
                                      Images images,
                                      std::span<const CandidateLandmark> landmarks,
                                      const std::set<LandmarkId>& already_sent) {
  const Candidates candidates = candidates_in(selection, images, landmarks);
  Capacity capacity(images, selection.max_per_keyframe, already_sent);
  std::set<LandmarkId> selected = already_sent;
  for (std::size_t image = images.size(); image-- > 0;) {
    for (const Candidate* candidate : spread(selection, *images[image], candidates)) {
      if (!capacity.has_room(image)) break;
      if (selected.contains(candidate->landmark->id) ||
          !capacity.has_room_in_all(candidate->seen_in)) {
        continue;
      }
      capacity.use(candidate->seen_in);
      selected.insert(candidate->landmark->id);
    }
  }
  return selected;
}

int reliable_landmarks(const LandmarkSelection& selection,
                       std::span<const CandidateLandmark> landmarks) {
  return static_cast<int>(std::ranges::count_if(landmarks, [&](const CandidateLandmark& landmark) {
    return is_reliable(selection, landmark);
  }));
}

}  // namespace fleetloc
