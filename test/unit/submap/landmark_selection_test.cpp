#include "robot/submap/landmark_selection.hpp"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr LandmarkSelection kSelection{.more_observations_than = 2,
                                       .max_relative_depth_sigma = 0.1,
                                       .max_per_keyframe = 4,
                                       .cell_px = 100.0};

CandidateLandmark candidate(std::uint32_t id, int observations = 3, double depth_sigma = 0.01) {
  return {LandmarkId{id}, Eigen::Vector3d::Zero(), observations, depth_sigma};
}

StereoObservation seen(std::uint32_t id, double u, double v) {
  return {LandmarkId{id}, {u, v}, 5.0};
}

std::vector<std::uint32_t> selected_of(const std::vector<std::vector<StereoObservation>>& images,
                                       const std::vector<CandidateLandmark>& landmarks,
                                       const std::set<LandmarkId>& kept = {}) {
  std::vector<const std::vector<StereoObservation>*> views;
  views.reserve(images.size());
  for (const auto& image : images) views.push_back(&image);
  std::vector<std::uint32_t> ids;
  for (const LandmarkId id : select_landmarks(kSelection, views, landmarks, kept)) {
    ids.push_back(static_cast<std::uint32_t>(id));
  }
  return ids;
}

TEST(LandmarkSelection, NeedsMoreThanThetaObservations) {
  EXPECT_THAT(selected_of({{seen(1, 10, 10), seen(2, 20, 20)}}, {candidate(1, 2), candidate(2, 3)}),
              ElementsAre(2));
}

TEST(LandmarkSelection, NeedsACertainDepth) {
  EXPECT_THAT(selected_of({{seen(1, 10, 10), seen(2, 20, 20)}},
                          {candidate(1, 5, 0.11), candidate(2, 5, 0.1)}),
              ElementsAre(2));
}

TEST(LandmarkSelection, LeavesOutWhatNoImageSees) {
  EXPECT_THAT(selected_of({{}}, {candidate(1)}), IsEmpty());
}

TEST(LandmarkSelection, SpreadsThemOverTheImage) {
  // Four in one cell are seen more often than three lonely ones.
  const std::vector<StereoObservation> image{seen(1, 10, 10),
                                             seen(2, 20, 10),
                                             seen(3, 30, 10),
                                             seen(4, 40, 10),
                                             seen(5, 210, 10),
                                             seen(6, 310, 310),
                                             seen(7, 10, 410)};
  EXPECT_THAT(selected_of({image},
                          {candidate(1, 8),
                           candidate(2, 9),
                           candidate(3, 8),
                           candidate(4, 8),
                           candidate(5),
                           candidate(6),
                           candidate(7)}),
              ElementsAre(2, 5, 6, 7));
}

TEST(LandmarkSelection, GivesRoomToWhatWasSentBefore) {
  const std::vector<StereoObservation> image{
      seen(1, 10, 10), seen(2, 20, 10), seen(3, 110, 10), seen(4, 210, 10), seen(5, 310, 10)};
  const std::vector<CandidateLandmark> landmarks{candidate(3), candidate(4, 9), candidate(5)};
  EXPECT_THAT(selected_of({image}, landmarks, {LandmarkId{1}, LandmarkId{2}, LandmarkId{5}}),
              ElementsAre(1, 2, 4, 5));
}

TEST(LandmarkSelection, KeepsTheLimitInEveryImage) {
  std::vector<std::vector<StereoObservation>> images(3);
  std::vector<CandidateLandmark> landmarks;
  for (std::uint32_t id = 0; id < 30; ++id) {
    landmarks.push_back(candidate(id, 3 + static_cast<int>(id % 4)));
    for (std::size_t image = id % 2; image < 3; ++image) {
      images[image].push_back(seen(id, 37.0 * id, 20.0 * (id % 5)));
    }
  }
  const auto ids = selected_of(images, landmarks);
  EXPECT_GE(ids.size(), 4U);
  for (const auto& image : images) {
    EXPECT_LE(std::ranges::count_if(image,
                                    [&](const StereoObservation& one) {
                                      return std::ranges::count(
                                                 ids, static_cast<std::uint32_t>(one.landmark)) > 0;
                                    }),
              4);
  }
}

}  // namespace
}  // namespace fleetloc
