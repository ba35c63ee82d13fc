#include "robot/odometry/outlier_tracks.hpp"

#include <initializer_list>

#include <gmock/gmock.h>

namespace fleetloc {
namespace {

using ::testing::ElementsAre;

TrackedFrame frame_with(std::initializer_list<std::uint32_t> landmarks) {
  TrackedFrame frame;
  for (const std::uint32_t id : landmarks) {
    frame.observations.emplace_back().landmark = LandmarkId{id};
  }
  return frame;
}

std::vector<std::uint32_t> landmarks_of(const TrackedFrame& frame) {
  std::vector<std::uint32_t> ids;
  for (const StereoObservation& seen : frame.observations) {
    ids.push_back(static_cast<std::uint32_t>(seen.landmark));
  }
  return ids;
}

TEST(OutlierTracks, StayOutForAsLongAsTheyAreTracked) {
  OutlierTracks outliers;
  outliers.add({LandmarkId{2}}, frame_with({1, 2, 3}));
  EXPECT_THAT(landmarks_of(outliers.removed_from(frame_with({1, 2, 3}))), ElementsAre(1, 3));
  outliers.add({LandmarkId{3}}, frame_with({2, 3, 4}));
  EXPECT_THAT(landmarks_of(outliers.removed_from(frame_with({2, 3, 4}))), ElementsAre(4));
  outliers.add({}, frame_with({3, 4}));  // 2 has been lost
  EXPECT_THAT(landmarks_of(outliers.removed_from(frame_with({2, 3, 4}))), ElementsAre(2, 4));
  outliers.clear();
  EXPECT_THAT(landmarks_of(outliers.removed_from(frame_with({2, 3, 4}))), ElementsAre(2, 3, 4));
}

}  // namespace
}  // namespace fleetloc
